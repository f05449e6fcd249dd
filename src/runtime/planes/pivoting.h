/* Complete pivoting for Gauss elimination. */
#ifndef PIVOTING_H
#define PIVOTING_H

#include <stddef.h>

/* A matrix by rows; order: the original index of each column, since columns are exchanged. */
struct Pivoting {
  size_t rows, columns;
  double *matrix, *order;
};

/* Sets the order of the columns to the original one. */
void pivoting_begin(const struct Pivoting *pivoting);

/*
 * Moves the largest element from row and column k on to position (k, k). *row: the row with which row k was exchanged.
 * Returns the size of the element.
 */
double pivoting_take(const struct Pivoting *pivoting, size_t k, size_t *row);

#endif
