/* The expressions of definitions.h: what each <define>, calculated <parameter>, particle and body gives. */
#pragma once

#include "read/context/includes.h"
#include "read/names/definitions.h"

/* Whether a <parameter> or <input> has a value, its own or a given one, in place of a start. */
bool has_value(xmlNodePtr node, const struct Given *given);

/* Collects the expression of a <define>, or of a <parameter> or <input> that has a value. */
void collect_value(struct Reader *reader, xmlNodePtr node);

/*
 * Collects the components of a <frame>, <point>, <particle> or <body>. Of several of one name, which is reported later, the first one
 * has them.
 */
void collect_components(struct Reader *reader, xmlNodePtr node);

/* Its value; name: its own. */
struct Quantity read_named_expression(struct Reader *reader, const struct NamedExpression *expression,
                                      const char *name);

/*
 * Enters the value of a <define>, <parameter> or <input> into the model, under its name; bodies enter their components.
 */
void keep_named_expression(struct Reader *reader, xmlNodePtr node, const char *name, struct Quantity value);
