/* Checks of arguments; each logs an error. */
#pragma once

#include "instance/instance.h"

/* True if an array argument is not NULL, or has no elements. */
bool check_array(struct Instance *instance, const void *array, size_t count, const char *argument);

/* Returns the variable of this value reference and type; NULL after logging an error. */
const struct ScalarVariable *check_reference(struct Instance *instance, unsigned reference, enum VariableType type);
