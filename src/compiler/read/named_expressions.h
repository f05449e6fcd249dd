/* The expressions of definitions.h: what each <define>, calculated <parameter>, particle and body gives. */
#ifndef NAMED_EXPRESSIONS_H
#define NAMED_EXPRESSIONS_H

#include "read/attributes.h"

/* Whether this is a <parameter> with a value, which follows from others, in place of a start. */
bool is_calculated(xmlNodePtr node);

/* Collects the named expressions of an element, if it has any. */
void collect_named_expressions(struct Reader *reader, xmlNodePtr node);

/* The value of a <define>, or of a component of a particle or body or a <parameter>, for NULL or the attribute's name. */
struct Quantity read_named_expression(struct Reader *reader, xmlNodePtr node, const char *attribute);

/* Enters the value of a <define> or a <parameter> into the model, under its name; bodies enter their components. */
void keep_named_expression(struct Reader *reader, xmlNodePtr node, const char *name, struct Quantity value);

#endif
