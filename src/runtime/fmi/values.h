/* Gets and sets variables by their value references. Each function logs errors. */
#ifndef VALUES_H
#define VALUES_H

#include "fmi/life_cycle.h"

enum Status values_get(struct Instance *instance, const unsigned *reference, size_t count, double *value);

/* Integer or Boolean variables; a larger count than INT_MAX is reported as that. */
enum Status values_get_whole(struct Instance *instance, const unsigned *reference, size_t count, int *value,
                             enum VariableType type);

/* The statistics, as 64-bit counters. */
enum Status values_get_counts(struct Instance *instance, const unsigned *reference, size_t count, int64_t *value);

/* For types without variables: any reference is an error. */
enum Status values_none(void *component, enum Function function, size_t count, const char *name);

/* Sets all values or none. */
enum Status values_set(struct Instance *instance, const unsigned *reference, size_t count, const double *value);

/* The same for Integer or Boolean variables. */
enum Status values_set_whole(struct Instance *instance, const unsigned *reference, size_t count, const int *value,
                             enum VariableType type);

/* Sets time derivatives of inputs for the next communication step; all or none. */
enum Status values_set_input_derivatives(struct Instance *instance, const unsigned *reference, size_t count,
                                         const int *order, const double *value);

#endif
