/* Distribution of a load among frictions in planes, within their limits and with a margin. */
#ifndef SHARED_LOADS_H
#define SHARED_LOADS_H

#include <stdbool.h>
#include <stddef.h>

/* Forces along and across for count planes, in units of their limits. */
struct SharedLoad {
  size_t rows, count;
  double *jacobian_row; /* rows x 2 count: generalized forces of unit forces, G; overwritten */
  double *share;        /* forces that carry the load: any on entry, those with a margin on return */
  double *work;
};

/* Returns the bytes of a problem with these numbers of rows and planes. */
size_t shared_load_bytes(size_t rows, size_t count);

/* Divides a block of shared_load_bytes() among the parts. */
struct SharedLoad shared_load_in(void *block, size_t rows, size_t count);

/*
 * LOAD_IS_SHARED: all forces are below their limits. LOAD_IS_AT_LIMIT: the largest equals its limit within rounding.
 * LOAD_OVERCOMES: every distribution exceeds a limit, or there is no choice since the forces are unique.
 */
enum LoadSharing { LOAD_IS_SHARED, LOAD_IS_AT_LIMIT, LOAD_OVERCOMES };

/* Finds forces within the limits that leave a large margin; if there are none, those whose largest is least. */
enum LoadSharing shared_load_carry(struct SharedLoad *load);

/* Returns the size of a plane's force. */
double shared_load_size(const struct SharedLoad *load, size_t plane);

#endif
