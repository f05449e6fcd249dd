/* Makes variables of the model from elements. */
#pragma once

#include "read/context/attributes.h"

/* Returns a variable with the element's name, description and units; all else is unset. */
struct Variable common_attributes(struct Reader *reader, xmlNodePtr node);

/* Returns the display unit in an attribute, for values of this dimension; NULL if missing or after an error. */
char *display_unit_attribute(struct Reader *reader, xmlNodePtr node, const char *name, struct Dimension dimension);

/* Reports a minimum above the maximum, or a start value outside of them. */
void check_range(struct Reader *reader, const struct Variable *variable);

/* Appends an input without time derivatives to the model and returns its symbol. */
Node append_input(struct Reader *reader, struct Variable variable);

/* Appends a copy of the variable; returns it. It moves when the list grows. */
struct Variable *append_variable(struct VariableList *list, struct Variable variable);
