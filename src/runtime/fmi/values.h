/* Getting and setting variables by their value references. Each function logs what is wrong. */
#ifndef VALUES_H
#define VALUES_H

#include "fmi/life_cycle.h"

enum Status values_get(struct Instance *instance, const unsigned *reference, size_t count, double *value);

/* Integer or Boolean variables; counts that are too large for one are the largest that there is. */
enum Status values_get_whole(struct Instance *instance, const unsigned *reference, size_t count, int *value,
                             enum VariableType type);

/* Counts in full: the statistics alone. */
enum Status values_get_counts(struct Instance *instance, const unsigned *reference, size_t count, int64_t *value);

/* Of a type that no variable has: any reference is an error. */
enum Status values_none(void *component, enum Function function, size_t count, const char *name);

/* Sets all values or none. */
enum Status values_set(struct Instance *instance, const unsigned *reference, size_t count, const double *value);

/* The same of Integer or Boolean variables. */
enum Status values_set_whole(struct Instance *instance, const unsigned *reference, size_t count, const int *value,
                             enum VariableType type);

/* The derivatives of inputs by time, for the communication step to come; all or none. */
enum Status values_set_input_derivatives(struct Instance *instance, const unsigned *reference, size_t count,
                                         const int *order, const double *value);

#endif
