/* Checks of arguments; each logs an error. */
#ifndef CHECK_H
#define CHECK_H

#include "instance/instance.h"

/* Whether an array argument is there when it has elements. */
bool check_array(struct Instance *instance, const void *array, size_t count, const char *argument);

/* The variable of this value reference, of this type; NULL after logging. */
const struct ScalarVariable *check_reference(struct Instance *instance, unsigned reference, enum VariableType type);

#endif
