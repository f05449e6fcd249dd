/* Checks that every FMI function begins with. */
#ifndef CHECK_H
#define CHECK_H

#include "instance.h"

/* Whether function may be called now; logs an error under this name where it may not. c must not be NULL. */
bool check_call(struct Instance *instance, enum Function function, const char *name);

/* Whether an array argument is there when it has elements; logs an error where it is not. */
bool check_array(struct Instance *instance, const void *array, size_t count, const char *function,
                 const char *argument);

/* The variable of this value reference, of type Integer or Real; NULL after logging an error. */
const struct ScalarVariable *check_reference(struct Instance *instance, fmi2ValueReference reference, bool integer,
                                             const char *function);

#endif
