/* Full pivoting, for Gauss elimination. */
#ifndef PIVOTING_H
#define PIVOTING_H

#include <stddef.h>

/* A matrix by rows, with the number of each column of it: columns change places. */
struct Pivoting {
  size_t rows, columns;
  double *matrix, *order;
};

void pivoting_begin(const struct Pivoting *pivoting);

/*
 * The largest element from row and column k on comes to their crossing, from *row, with which row k has changed places. Returns its
 * size.
 */
double pivoting_take(const struct Pivoting *pivoting, size_t k, size_t *row);

#endif
