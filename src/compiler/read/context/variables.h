/* What elements declare becomes variables of the model. */
#pragma once

#include "read/context/attributes.h"

/* Name, description and units; the rest is not there. */
struct Variable common_attributes(struct Reader *reader, xmlNodePtr node);

/* The display unit in an attribute of the element, for what has this dimension; NULL where missing or after an error. */
char *display_unit_attribute(struct Reader *reader, xmlNodePtr node, const char *name, struct Dimension dimension);

/* Reports a range or a start value that does not fit. */
void check_range(struct Reader *reader, const struct Variable *variable);

/* An input without a rate; returns its symbol. */
Node append_input(struct Reader *reader, struct Variable variable);

struct Variable *append_variable(struct VariableList *list, struct Variable variable);
