#include "nonsymmetric.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "saddle.h"

/* Smallest pivot of 1 + E^T S C. Below it the forces have no solution, or many: friction that locks. */
static const double smallest_locking_pivot = 1e-12;

/* Offsets of the parts of m after those of the symmetric matrix. */
struct Nonsymmetric {
  size_t count;      /* r */
  const int *force;  /* rows of the forces from which others follow */
  size_t c;          /* C */
  size_t active;     /* the number a of columns that take part, then these */
  size_t response;   /* S C of these columns */
  size_t factor;     /* 1 + E^T S C, a by a, later its factors L U, by rows */
  size_t pivot;      /* pivot row of each column */
  size_t right_side; /* SADDLE_RIGHT_SIDE(n) */
};

static struct Nonsymmetric nonsymmetric_of(size_t n, const size_t *start, const size_t *column, const int *coordinate) {
  struct Nonsymmetric nonsymmetric = {.count = (size_t)coordinate[n], .force = coordinate + n + 1};
  size_t constraints = 0;
  for (size_t i = 0; i < n; i++) constraints += coordinate[i] < 0 ? 1 : 0;
  nonsymmetric.c = SADDLE_MASS(start[n], column[start[n] + n], n, constraints);
  nonsymmetric.active = nonsymmetric.c + n * nonsymmetric.count;
  nonsymmetric.response = nonsymmetric.active + nonsymmetric.count + 1;
  nonsymmetric.factor = nonsymmetric.response + n * nonsymmetric.count;
  nonsymmetric.pivot = nonsymmetric.factor + nonsymmetric.count * nonsymmetric.count;
  nonsymmetric.right_side = nonsymmetric.pivot + nonsymmetric.count;
  return nonsymmetric;
}

static void swap_rows(double *a, size_t columns, size_t first, size_t second) {
  for (size_t j = 0; j < columns && first != second; j++) {
    double other = a[first * columns + j];
    a[first * columns + j] = a[second * columns + j];
    a[second * columns + j] = other;
  }
}

/* Factors the r x r matrix a by rows, with partial pivoting. False if it is singular. */
static bool eliminate_small(size_t r, double *a, double *pivot) {
  for (size_t k = 0; k < r; k++) {
    size_t best = k;
    for (size_t i = k + 1; i < r; i++)
      if (fabs(a[i * r + k]) > fabs(a[best * r + k])) best = i;
    pivot[k] = (double)best;
    if (!(fabs(a[best * r + k]) > smallest_locking_pivot)) return false;
    swap_rows(a, r, best, k);
    for (size_t i = k + 1; i < r; i++) {
      double share = a[i * r + k] /= a[k * r + k];
      for (size_t j = k + 1; j < r && share != 0.0; j++) a[i * r + j] -= share * a[k * r + j];
    }
  }
  return true;
}

static void solve_small(size_t r, const double *a, const double *pivot, double *x) {
  for (size_t k = 0; k < r; k++) swap_rows(x, 1, (size_t)pivot[k], k);
  for (size_t i = 0; i < r; i++)
    for (size_t j = 0; j < i; j++) x[i] -= a[i * r + j] * x[j];
  for (size_t i = r; i-- > 0;) {
    for (size_t j = i + 1; j < r; j++) x[i] -= a[i * r + j] * x[j];
    x[i] /= a[i * r + i];
  }
}

/* Solves with least-norm constraint forces, from which the other forces follow. */
static void solve_symmetric(size_t n, const size_t *start, const size_t *column, const int *coordinate, const double *m,
                            double *x) {
  saddle_solve(n, start, column, m, x);
  saddle_least_forces(n, start, column, coordinate, m, x);
}

/* True if a number of an array is not 0. */
static bool has_part(size_t count, const double *numbers) {
  bool has = false;
  for (size_t i = 0; i < count; i++) has |= numbers[i] != 0.0;
  return has;
}

/* True if the row of a constraint has elements that are not 0, which that of an open contact has not. */
static bool is_filled(size_t n, const size_t *start, const size_t *column, const double *m, int row) {
  const size_t *first = column + start[n] + row; /* of the rows of K */
  return has_part(first[1] - first[0], m + start[n] + first[0]);
}

/* Notes the columns of C that take part. Returns their number. */
static size_t find_active(size_t n, const size_t *start, const size_t *column, const struct Nonsymmetric *nonsymmetric,
                          double *m) {
  double *active = m + nonsymmetric->active + 1;
  size_t count = 0;
  for (size_t k = 0; k < nonsymmetric->count; k++)
    if (is_filled(n, start, column, m, nonsymmetric->force[k]) && has_part(n, m + nonsymmetric->c + k * n))
      active[count++] = (double)k;
  m[nonsymmetric->active] = (double)count;
  return count;
}

/* Returns the row of the force of an active column. */
static int row_of_force(const struct Nonsymmetric *nonsymmetric, const double *m, size_t k) {
  return nonsymmetric->force[(size_t)m[nonsymmetric->active + 1 + k]];
}

size_t nonsymmetric_factor(size_t n, const size_t *start, const size_t *column, const int *coordinate, double *m) {
  size_t singular = saddle_factor(n, start, column, coordinate, m);
  if (singular != 0) return singular;
  struct Nonsymmetric nonsymmetric = nonsymmetric_of(n, start, column, coordinate);
  double *right_side = m + nonsymmetric.right_side, *factor = m + nonsymmetric.factor;
  size_t count = find_active(n, start, column, &nonsymmetric, m);
  for (size_t k = 0; k < count; k++) {
    size_t c = nonsymmetric.c + (size_t)m[nonsymmetric.active + 1 + k] * n;
    memcpy(right_side, m + c, n * sizeof *right_side);
    solve_symmetric(n, start, column, coordinate, m, right_side);
    memcpy(m + nonsymmetric.response + k * n, right_side, n * sizeof *right_side);
    for (size_t i = 0; i < count; i++)
      factor[i * count + k] = (i == k ? 1.0 : 0.0) + right_side[row_of_force(&nonsymmetric, m, i)];
  }
  return eliminate_small(count, factor, m + nonsymmetric.pivot) ? 0 : 1;
}

void nonsymmetric_solve(size_t n, const size_t *start, const size_t *column, const int *coordinate, const double *m,
                        double *x) {
  struct Nonsymmetric nonsymmetric = nonsymmetric_of(n, start, column, coordinate);
  size_t count = (size_t)m[nonsymmetric.active];
  double *free_force = x + n; /* free, as r < n */
  solve_symmetric(n, start, column, coordinate, m, x);
  for (size_t k = 0; k < count; k++) free_force[k] = x[row_of_force(&nonsymmetric, m, k)];
  solve_small(count, m + nonsymmetric.factor, m + nonsymmetric.pivot, free_force);
  for (size_t k = 0; k < count; k++)
    for (size_t i = 0; i < n; i++) x[i] -= free_force[k] * m[nonsymmetric.response + k * n + i];
}
