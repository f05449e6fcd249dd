#include "saddle.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "ldlt.h"

/* A pivot of M below this share of its diagonal element has lost all its digits. */
static const double smallest_share_of_mass = 1e-14;

/*
 * A constraint with less of its row left than this share, squared, follows from the others: what rounding leaves of one
 * that does is smaller, and one that nearly does so would have no digits left.
 */
static const double smallest_share = 1e-12;

/* Solutions keep most of their digits where the weakest constraint has more than this share. */
static const double weak_share = 1e-3;

static double positive(double value) {
  return value > 0.0 ? value : 0.0;
}

size_t saddle_factor(size_t n, const size_t *start, const size_t *column, const int *coordinate, double *m) {
  double *weakest = m + 2 * start[n];
  memcpy(m + start[n], m, start[n] * sizeof *m);
  *weakest = 1.0;
  for (size_t i = 0; i < n; i++) {
    size_t last = start[i + 1] - 1;
    double diagonal = m[last], pivot = diagonal, mobility = 0.0; /* mobility: J M^-1 J^T of the constraint alone */
    for (size_t k = start[i]; k < last; k++) m[k] -= ldlt_product_of_rows(start, column, m, i, k);
    for (size_t k = start[i]; k < last; k++) {
      double l = m[k] / m[start[column[k] + 1] - 1], term = l * m[k];
      pivot -= term;
      mobility += positive(term);
      m[k] = l;
    }
    bool is_constraint = coordinate[i]<0, has_hold = -pivot> smallest_share * mobility;
    if (!is_constraint && !(pivot > smallest_share_of_mass * diagonal)) return i + 1;
    m[last] = is_constraint && !has_hold ? -INFINITY : pivot;
    if (is_constraint && has_hold) *weakest = fmin(*weakest, -pivot / mobility);
  }
  return 0;
}

/* rest = b - K x */
static void subtract_product(size_t n, const size_t *start, const size_t *column, const double *matrix, const double *b,
                             const double *x, double *rest) {
  memcpy(rest, b, n * sizeof *rest);
  for (size_t i = 0; i < n; i++)
    for (size_t k = start[i]; k < start[i + 1]; k++) {
      size_t j = column[k];
      rest[i] -= matrix[k] * x[j];
      if (i != j) rest[j] -= matrix[k] * x[i];
    }
}

void saddle_solve(size_t n, const size_t *start, const size_t *column, const double *m, double *x) {
  double *b = x + n, *rest = b + n;
  bool is_weak = m[2 * start[n]] < weak_share;
  if (is_weak) memcpy(b, x, n * sizeof *b);
  ldlt_solve(n, start, column, m, x);
  if (!is_weak) return;
  subtract_product(n, start, column, m + start[n], b, x, rest);
  ldlt_solve(n, start, column, m, rest);
  for (size_t i = 0; i < n; i++) x[i] += rest[i];
}
