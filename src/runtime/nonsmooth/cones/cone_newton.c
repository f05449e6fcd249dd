/*
 * Semismooth Newton method for the conditions of an impact, u = rate + W p, in the form of Alart and Curnier (Comput.
 * Methods Appl. Mech. Eng. 92, 1991): each impulse is a projection,
 *
 *   contact:   p = max(p - u / w, 0),
 *   friction:  p = projection of p - u / w onto the disk of radius mu p_contact, along a line onto the interval,
 *
 * where w is cones->scale. A row is scaled to a rate: it is u where the projection changes nothing, w p where a contact
 * opens, and w (p - limit direction) where a friction slides. The rows are piecewise linear, except for the directions
 * of slip. The derivative is factored by elimination with complete pivoting, O(n^3) a step. Impulses that it does not
 * determine keep their values. A step may be halved until it reduces the residual enough, as whole ones may go back and
 * forth between two pieces. The method ends where none does.
 */
#include "nonsmooth/cones/cone_newton.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "support/arena.h"

/* Largest number of Newton steps; a few suffice once the active pieces are right. */
enum { NEWTON_LIMIT = 60 };

/* A step must reduce the residual by this share of its length, which is 1 for a whole step. */
static const double least_gain_of_step = 0.1;

/*
 * Smaller pivots, relative to the largest, count as 0. Smaller residuals, relative to the largest impulse as a rate, are
 * rounding errors.
 */
static const double least_law_pivot = 1e-13, rounded_miss = 2.0 * DBL_EPSILON;

/* A Newton iteration for n impulses. Matrices have n x n elements, by rows. */
struct ConeNewton {
  struct Cones *cones;
  size_t n;
  double *miss, *slope; /* residual, as rates, and its derivatives by scaled impulses, by rows */
  double *step, *before, *column;
};

static size_t lay_out_newton(struct ConeNewton *newton, size_t n, double *work) {
  struct Arena arena = {(uintptr_t)work};
  ARENA_NUMBERS(&arena, n * n, &newton->slope);
  ARENA_NUMBERS(&arena, n, &newton->miss, &newton->step, &newton->before, &newton->column);
  return (arena.next - (uintptr_t)work) / sizeof(double);
}

size_t cone_newton_work_count(size_t n) {
  struct ConeNewton newton;
  return lay_out_newton(&newton, n, NULL);
}

static double *slope_row(const struct ConeNewton *newton, size_t row) {
  return newton->slope + row * newton->n;
}

/* Fills a row with the rate after the impact and its derivatives. */
static void fill_rate(const struct ConeNewton *newton, size_t row) {
  const struct Cones *cones = newton->cones;
  double *slope = slope_row(newton, row);
  newton->miss[row] = cones_rate_behind(cones, row);
  for (size_t j = 0; j < newton->n; j++)
    slope[j] = cones->scale[j] > 0.0 ? cones->impulses->delassus[row * newton->n + j] / cones->scale[j] : 0.0;
}

/* Fills a row for an impulse that is to be 0; with a scale of 0 the impulse is not determined. */
static void fill_nothing(const struct ConeNewton *newton, size_t row) {
  memset(slope_row(newton, row), 0, newton->n * sizeof(double));
  slope_row(newton, row)[row] = 1.0;
  newton->miss[row] = newton->cones->scale[row] * newton->cones->impulse[row];
}

static void fill_law_of_contact(const struct ConeNewton *newton, size_t row) {
  const struct Cones *cones = newton->cones;
  fill_rate(newton, row);
  if (!(cones->scale[row] * cones->impulse[row] - newton->miss[row] > 0.0)) fill_nothing(newton, row);
}

/*
 * Fills the rows of a sliding friction. wish: scaled impulse before its projection, of this size. The rows, which hold
 * the rates, become those of impulse - limit wish / size.
 */
static void fill_sliding(const struct ConeNewton *newton, size_t row, size_t rows, const double *wish, double size,
                         double limit) {
  const struct Cones *cones = newton->cones;
  double scale = cones->scale[row], share = limit * scale / size;
  for (size_t j = 0; j < newton->n; j++) {
    double turn[2], along = 0.0;
    for (size_t i = 0; i < rows; i++) {
      turn[i] = (j == row + i ? 1.0 : 0.0) - slope_row(newton, row + i)[j];
      along += turn[i] * wish[i] / size;
    }
    bool decides = j < cones->impulses->deciding_count && limit > 0.0 && cones->scale[j] > 0.0;
    double grows = decides ? cones_coefficient(cones, row, j) * scale / cones->scale[j] : 0.0;
    for (size_t i = 0; i < rows; i++) {
      double across = turn[i] - along * wish[i] / size;
      slope_row(newton, row + i)[j] = (j == row + i ? 1.0 : 0.0) - grows * wish[i] / size - share * across;
    }
  }
  for (size_t i = 0; i < rows; i++) newton->miss[row + i] = scale * cones->impulse[row + i] - share * wish[i];
}

static void fill_law_of_friction(const struct ConeNewton *newton, size_t row, size_t rows) {
  const struct Cones *cones = newton->cones;
  double wish[2] = {0.0, 0.0}, limit = fmax(cones_limit(cones, row), 0.0);
  for (size_t i = 0; i < rows; i++) {
    if (cones->scale[row] > 0.0) fill_rate(newton, row + i);
    else fill_nothing(newton, row + i);
    wish[i] = cones->scale[row] * cones->impulse[row + i] - newton->miss[row + i];
  }
  double size = hypot(wish[0], wish[1]);
  if (size > cones->scale[row] * limit) fill_sliding(newton, row, rows, wish, size, limit);
}

/* Fills all rows. Returns the largest residual; INFINITY if any is not finite. */
static double fill_equations(const struct ConeNewton *newton) {
  double most = 0.0;
  for (size_t row = 0; row < newton->n;) {
    size_t rows = cones_row_count(newton->cones, row);
    if (row < newton->cones->impulses->contact_count) fill_law_of_contact(newton, row);
    else fill_law_of_friction(newton, row, rows);
    row += rows;
  }
  for (size_t row = 0; row < newton->n; row++) most = fmax(most, fabs(newton->miss[row]));
  for (size_t row = 0; row < newton->n; row++) most = isfinite(newton->miss[row]) ? most : INFINITY;
  return most;
}

static void exchange(double *one, double *other) {
  double number = *one;
  *one = *other;
  *other = number;
}

/*
 * Exchanges the largest element of the slope from row and column k on with that at (k, k), and the residuals of the
 * rows. Returns the size of the element. column: the original index of each column.
 */
static double take_pivot(const struct ConeNewton *newton, size_t k) {
  size_t n = newton->n, row = k, column = k;
  double largest = 0.0;
  for (size_t i = k; i < n; i++) {
    const double *slope = slope_row(newton, i);
    for (size_t j = k; j < n; j++) {
      double size = fabs(slope[j]);
      if (!(size > largest)) continue;
      largest = size;
      row = i;
      column = j;
    }
  }
  for (size_t j = 0; j < n && row != k; j++) exchange(&slope_row(newton, row)[j], &slope_row(newton, k)[j]);
  for (size_t i = 0; i < n && column != k; i++) exchange(&slope_row(newton, i)[column], &slope_row(newton, i)[k]);
  exchange(&newton->column[column], &newton->column[k]);
  exchange(&newton->miss[row], &newton->miss[k]);
  return largest;
}

/* Finds the Newton step by elimination with complete pivoting; components that are not determined are 0. */
static void find_step(const struct ConeNewton *newton) {
  size_t n = newton->n, rank = 0;
  double largest = 0.0;
  for (size_t j = 0; j < n; j++) newton->column[j] = (double)j;
  for (; rank < n; rank++) {
    double pivot = take_pivot(newton, rank);
    largest = fmax(largest, pivot);
    if (!(pivot > least_law_pivot * largest)) break;
    const double *first = slope_row(newton, rank);
    for (size_t i = rank + 1; i < n; i++) {
      double *row = slope_row(newton, i), share = row[rank] / first[rank];
      for (size_t j = rank + 1; j < n && share != 0.0; j++) row[j] -= share * first[j];
      newton->miss[i] -= share * newton->miss[rank];
    }
  }
  memset(newton->step, 0, n * sizeof *newton->step);
  for (size_t k = rank; k-- > 0;) {
    double sum = newton->miss[k];
    for (size_t j = k + 1; j < rank; j++) sum -= slope_row(newton, k)[j] * newton->step[(size_t)newton->column[j]];
    newton->step[(size_t)newton->column[k]] = sum / slope_row(newton, k)[k];
  }
}

/* Takes the step, or a part of it that reduces the residual enough. Returns the residual; that before if none does. */
static double take_newton_step(const struct ConeNewton *newton, double miss, double shortest_step) {
  struct Cones *cones = newton->cones;
  size_t bytes = newton->n * sizeof(double);
  memcpy(newton->before, cones->impulse, bytes);
  for (double length = 1.0; length >= shortest_step; length *= 0.5) {
    for (size_t i = 0; i < newton->n; i++)
      if (cones->scale[i] > 0.0) cones->impulse[i] = newton->before[i] - length * newton->step[i] / cones->scale[i];
    double next = fill_equations(newton);
    if (next < (1.0 - least_gain_of_step * length) * miss) return next;
  }
  memcpy(cones->impulse, newton->before, bytes);
  return miss;
}

double cone_newton(struct Cones *cones, double shortest_step, double *work) {
  struct ConeNewton newton = {.cones = cones, .n = cones->impulses->count};
  lay_out_newton(&newton, newton.n, work);
  double miss = fill_equations(&newton), before = INFINITY;
  for (int count = 0; count < NEWTON_LIMIT && miss < before && miss > rounded_miss * cones_largest(cones); count++) {
    before = miss;
    find_step(&newton);
    miss = take_newton_step(&newton, miss, shortest_step);
  }
  return miss;
}
