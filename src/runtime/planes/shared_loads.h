/*
 * How frictions in planes share a load that does not determine their forces: so that each is within its limit, with something
 * to spare.
 */
#ifndef SHARED_LOADS_H
#define SHARED_LOADS_H

#include <stdbool.h>
#include <stddef.h>

/* Of so many planes, each with the forces along and across, in units of its limit. */
struct SharedLoad {
  size_t rows, count;
  double *lever; /* rows by rows, with what a force of 1 does, 2 count of them; this does not last */
  double *share; /* forces that carry the load at first, then others that do */
  double *work;
};

size_t shared_load_bytes(size_t rows, size_t count);

/* Where all of it is in a block of so many bytes. */
struct SharedLoad shared_load_in(void *block, size_t rows, size_t count);

/* LOAD_OVERCOMES: some forces are the only ones that carry it, or all go beyond the limits. LOAD_IS_AT_LIMIT: but for rounding. */
enum LoadSharing { LOAD_IS_SHARED, LOAD_IS_AT_LIMIT, LOAD_OVERCOMES };

/* Where there are forces within the limits, these leave much of what can be left; else those of which the largest is least. */
enum LoadSharing shared_load_carry(struct SharedLoad *load);

/* The size of a plane's force. */
double shared_load_size(const struct SharedLoad *load, size_t plane);

#endif
