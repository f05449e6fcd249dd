/*
 * Lemke's method: w = M z + q + 1 z0, from a large z0 on down to 0, along the path on which each row stays complementary.
 * Ties are broken by the inverse of the basis (lexicographically), so that it does not go round in circles.
 */
#include "contacts/complementarity.h"

#include <math.h>
#include <string.h>

#include "arithmetic.h"

enum { PIVOTS_A_ROW = 50 };

/* Less than this in a pivot is rounding. */
static const double least_pivot = 1e-12;

/* So is less than this between two ratios: where the first does not lead to the end, the next is tried. */
static const double least_differences[] = {1e-14, 1e-12, 1e-10};

/*
 * Rows of the equations for the variables of the basis: the coefficients of w, of z, of z0, and the right side. Variables
 * are numbered in this order.
 */
struct LemkeTableau {
  size_t n, width;
  double *row;   /* n rows of width */
  double *basis; /* the variable of each row */
  double least_difference;
};

size_t complementarity_work_count(size_t n) {
  return n * (2 * n + 2) + n;
}

static double *tableau_row(const struct LemkeTableau *tableau, size_t i) {
  return tableau->row + i * tableau->width;
}

static struct LemkeTableau fill_tableau(size_t n, const double *matrix, const double *q, double *work) {
  struct LemkeTableau tableau = {.n = n, .width = 2 * n + 2, .row = work, .basis = work + n * (2 * n + 2)};
  for (size_t i = 0; i < n; i++) {
    double *row = tableau_row(&tableau, i);
    for (size_t j = 0; j < n; j++) {
      row[j] = i == j ? 1.0 : 0.0;
      row[n + j] = -matrix[i * n + j];
    }
    row[2 * n] = -1.0;
    row[2 * n + 1] = q[i];
    tableau.basis[i] = (double)i;
  }
  return tableau;
}

static void pivot_at(const struct LemkeTableau *tableau, size_t leaving, size_t entering) {
  double *pivot_row = tableau_row(tableau, leaving), pivot = pivot_row[entering];
  for (size_t j = 0; j < tableau->width; j++) pivot_row[j] /= pivot;
  for (size_t i = 0; i < tableau->n; i++) {
    double *row = tableau_row(tableau, i), factor = row[entering];
    if (i == leaving || factor == 0.0) continue;
    for (size_t j = 0; j < tableau->width; j++) row[j] -= factor * pivot_row[j];
    row[entering] = 0.0;
  }
  tableau->basis[leaving] = (double)entering;
}

/* Whether row i comes to 0 before row k, as the entering variable grows: by its right side, then by the inverse. */
static bool is_first(const struct LemkeTableau *tableau, size_t entering, size_t i, size_t k) {
  const double *one = tableau_row(tableau, i), *other = tableau_row(tableau, k);
  double difference = one[tableau->width - 1] / one[entering] - other[tableau->width - 1] / other[entering];
  for (size_t j = 0; j < tableau->n && fabs(difference) <= tableau->least_difference; j++)
    difference = one[j] / one[entering] - other[j] / other[entering];
  return difference < 0.0;
}

/* The row whose variable leaves; n where none does. z0 goes first among those that come to 0 together. */
static size_t find_leaving(const struct LemkeTableau *tableau, size_t entering) {
  size_t n = tableau->n, found = n, last = 2 * n;
  for (size_t i = 0; i < n; i++)
    if (tableau_row(tableau, i)[entering] > least_pivot && (found == n || is_first(tableau, entering, i, found)))
      found = i;
  for (size_t i = 0; i < n && found < n; i++) {
    const double *row = tableau_row(tableau, i), *first = tableau_row(tableau, found);
    if (tableau->basis[i] != (double)last || !(row[entering] > least_pivot)) continue;
    if (row[last + 1] / row[entering] <= first[last + 1] / first[entering] + tableau->least_difference) found = i;
  }
  return found;
}

/* The row that the first pivot takes: that of the least q. */
static size_t find_least(const struct LemkeTableau *tableau) {
  size_t least = 0;
  for (size_t i = 1; i < tableau->n; i++)
    if (tableau_row(tableau, i)[tableau->width - 1] < tableau_row(tableau, least)[tableau->width - 1]) least = i;
  return least;
}

static bool follow_path(size_t n, const double *matrix, const double *q, double least_difference, double *z,
                        double *work) {
  struct LemkeTableau tableau = fill_tableau(n, matrix, q, work);
  size_t z0 = 2 * n, entering = z0, leaving = find_least(&tableau);
  tableau.least_difference = least_difference;
  memset(z, 0, n * sizeof *z);
  if (!(q[leaving] < 0.0)) return true;
  for (size_t count = 0; count < PIVOTS_A_ROW * n; count++) {
    size_t left = (size_t)tableau.basis[leaving];
    pivot_at(&tableau, leaving, entering);
    if (left == z0) {
      for (size_t i = 0; i < n; i++)
        if (tableau.basis[i] >= (double)n)
          z[(size_t)tableau.basis[i] - n] = fmax(tableau_row(&tableau, i)[z0 + 1], 0.0);
      return true;
    }
    entering = left < n ? left + n : left - n;
    leaving = find_leaving(&tableau, entering);
    if (leaving == n) return false;
  }
  return false;
}

bool complementarity_solve(size_t n, const double *matrix, const double *q, double *z, double *work) {
  bool is_solved = false;
  for (size_t i = 0; i < sizeof least_differences / sizeof *least_differences && !is_solved; i++)
    is_solved = follow_path(n, matrix, q, least_differences[i], z, work);
  return is_solved;
}
