/* Gets and sets variables by their value references. Each function logs errors. */
#pragma once

#include "fmi/life_cycle.h"

/* Gets Real variables. */
enum Status values_get(struct Instance *instance, const unsigned *reference, size_t count, double *value);

/* Gets Integer or Boolean variables; a statistic beyond INT_MAX is reported as INT_MAX. */
enum Status values_get_whole(struct Instance *instance, const unsigned *reference, size_t count, int *value,
                             enum VariableType type);

/* Gets statistics as 64-bit counters. */
enum Status values_get_counts(struct Instance *instance, const unsigned *reference, size_t count, int64_t *value);

/* Does nothing, for types without variables: any reference is an error. */
enum Status values_none(void *component, enum FunctionClass function, size_t count, const char *name);

/* Sets variables of a type: all or none. value: doubles for TYPE_REAL, else of the type int. */
enum Status values_set(struct Instance *instance, const unsigned *reference, size_t count, const void *value,
                       enum VariableType type);

/* Sets time derivatives of inputs for the next communication step; all or none. */
enum Status values_set_input_derivatives(struct Instance *instance, const unsigned *reference, size_t count,
                                         const int *order, const double *value);
