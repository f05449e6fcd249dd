/*
 * Collects and reads the named expressions of definitions.h: those of <define>, <output>, calculated <parameter>s and <input>s,
 * bodies, frames and rates.
 */
#pragma once

#include "read/context/includes.h"
#include "names/definitions.h"

/* True if a <parameter> or <input> has a value, its own or an override, instead of a start value. */
bool has_value(xmlNodePtr node, const struct Override *overrides);

/* Collects the expression of a <define>, or of a <parameter> or <input> with a value. */
void collect_value(struct Reader *reader, xmlNodePtr node);

/* Collects the expression of an <output>. */
void collect_output(struct Reader *reader, xmlNodePtr node);

/* Reads the expression of an <output> as others use it, with its unit; `unit` is unknown if it has none. */
struct Quantity read_output_value(struct Reader *reader, xmlNodePtr node, const char *name, struct Dimension unit);

/*
 * Collects the components of a <frame>, <point>, <particle> or <body>. If several have the same name, which is reported
 * later, the components are those of the first.
 */
void collect_components(struct Reader *reader, xmlNodePtr node);

/* Parses the expression. name: its full name. */
struct Quantity read_named_expression(struct Reader *reader, const struct NamedExpression *expression,
                                      const char *name);

/*
 * Stores the value of a <define>, <parameter>, <input> or rate in the model under its name. Elements of bodies and
 * frames store their components themselves.
 */
void keep_named_expression(struct Reader *reader, xmlNodePtr node, const char *name, struct Quantity value);
