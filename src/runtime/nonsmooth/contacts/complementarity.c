/*
 * Solves w = M z + q with w >= 0, z >= 0, w^T z = 0 by Lemke's method: complementary pivoting for w = M z + q + 1
 * z0, from a large z0 at z = 0 down to z0 = 0. Of each pair w_i, z_i one is 0 throughout; the partner of the
 * variable that leaves the basis enters next. Ties of the ratio test are broken lexicographically by the rows of
 * the inverse of the basis. So in exact arithmetic no basis returns, and the path is finite. A pivot costs O(n^2).
 * Columns that decide are refined, since rows of M may differ by a regularization alone. The path is given up at a
 * secondary ray (no row can leave) or after PIVOTS_A_ROW n pivots. Then it is tried again with a larger tolerance for
 * ties. Reference: Cottle, Pang and Stone, The Linear Complementarity Problem, chapter 4.
 */
#include "nonsmooth/contacts/complementarity.h"

#include <math.h>
#include <string.h>

#include "arithmetic.h"

/* Pivots for each row before a path is abandoned: in practice Lemke's method needs a few for each row. */
enum { PIVOTS_A_ROW = 50 };

/* Smaller pivots count as rounding errors; M and q are scaled to a size of 1. */
static const double least_pivot = 1e-12;

/* Ratios that differ by less are tied. The next value is tried if the path does not end in a solution. */
static const double least_differences[] = {1e-14, 1e-12, 1e-10};

/*
 * Equations solved for the variables of the basis: coefficients of w, of z and of z0, then the right side. Variables
 * are numbered in this order: w from 0 on, z from n on, z0 is 2 n.
 */
struct LemkeTableau {
  size_t n, width;
  const double *matrix, *q;
  double *row;   /* n x width */
  double *basis; /* the basic variable of each row, as an exact number */
  double *residual;
  double least_difference;
};

size_t complementarity_work_count(size_t n) {
  return n * (2 * n + 2) + 2 * n;
}

static double *tableau_row(const struct LemkeTableau *tableau, size_t i) {
  return tableau->row + i * tableau->width;
}

/* Returns an element of the equations before the first pivot. */
static double coefficient(const struct LemkeTableau *tableau, size_t i, size_t column) {
  size_t n = tableau->n;
  if (column < n) return i == column ? 1.0 : 0.0;
  if (column < 2 * n) return -tableau->matrix[i * n + column - n];
  return column == 2 * n ? -1.0 : tableau->q[i];
}

static struct LemkeTableau fill_tableau(size_t n, const double *matrix, const double *q, double *work) {
  size_t width = 2 * n + 2;
  double *basis = work + n * width;
  struct LemkeTableau tableau = {n, width, matrix, q, work, basis, basis + n, 0.0};
  for (size_t i = 0; i < n; i++) {
    for (size_t j = 0; j < width; j++) tableau_row(&tableau, i)[j] = coefficient(&tableau, i, j);
    basis[i] = (double)i;
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

/* Refines a column x = B^-1 a iteratively: x + B^-1 (a - B x). The columns of w hold the inverse of the basis B. */
static void refine_column(const struct LemkeTableau *tableau, size_t column) {
  size_t n = tableau->n;
  for (size_t i = 0; i < n; i++) {
    tableau->residual[i] = coefficient(tableau, i, column);
    for (size_t k = 0; k < n; k++)
      tableau->residual[i] -= coefficient(tableau, i, (size_t)tableau->basis[k]) * tableau_row(tableau, k)[column];
  }
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k < n; k++) tableau_row(tableau, i)[column] += tableau_row(tableau, i)[k] * tableau->residual[k];
}

/* True if row i limits the entering variable before row k does, with ties broken. */
static bool is_first(const struct LemkeTableau *tableau, size_t entering, size_t i, size_t k) {
  const double *one = tableau_row(tableau, i), *other = tableau_row(tableau, k);
  double difference = one[tableau->width - 1] / one[entering] - other[tableau->width - 1] / other[entering];
  for (size_t j = 0; j < tableau->n && fabs(difference) <= tableau->least_difference; j++)
    difference = one[j] / one[entering] - other[j] / other[entering];
  return difference < 0.0;
}

/* Returns the row of the leaving variable; n at a secondary ray. Of tied rows that of z0 is preferred. */
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

/* Returns the row of the least q, whose variable leaves first. */
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
    refine_column(&tableau, z0 + 1);
    if (left == z0) {
      for (size_t i = 0; i < n; i++)
        if (tableau.basis[i] >= (double)n)
          z[(size_t)tableau.basis[i] - n] = fmax(tableau_row(&tableau, i)[z0 + 1], 0.0);
      return true;
    }
    entering = left < n ? left + n : left - n;
    refine_column(&tableau, entering);
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
