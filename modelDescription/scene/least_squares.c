/*
 * Least squares min |A x - b| by modified Gram-Schmidt: A = Q R with b as a further column, then back substitution in
 * R x = Q^T b. A column that loses all but SMALL of its length is dependent. The rest of b is the residual. Costs
 * O(rows columns^2). G. Golub, C. Van Loan: Matrix Computations, section 5.2.
 */
#include "least_squares.h"

#include <math.h>

#include "base/memory.h"

/* Share of its length below which a column is linearly dependent, or a residual zero. */
static const double SMALL = 1e-9;

struct LeastSquares least_squares_create(size_t rows, size_t columns) {
  return (struct LeastSquares){rows, columns, allocate(rows * (columns + 1), sizeof(double))};
}

double *least_squares_row(const struct LeastSquares *system, size_t row) {
  return &system->entries[row * (system->columns + 1)];
}

static double product(const struct LeastSquares *system, size_t first, size_t second) {
  double sum = 0.0;
  for (size_t row = 0; row < system->rows; row++)
    sum += least_squares_row(system, row)[first] * least_squares_row(system, row)[second];
  return sum;
}

/* Subtracts factor times one column from another. */
static void subtract(const struct LeastSquares *system, size_t from, double factor, size_t column) {
  for (size_t row = 0; row < system->rows; row++)
    least_squares_row(system, row)[from] -= factor * least_squares_row(system, row)[column];
}

/* Orthogonalizes each column against those before it, and the right side against all. */
bool least_squares_solve(struct LeastSquares *system, size_t needed, double *solution) {
  size_t n = system->columns;
  double *upper = allocate((n + 1) * (n + 1), sizeof *upper), *size = allocate(n + 1, sizeof *size);
  bool is_unique = true;
  for (size_t j = 0; j <= n; j++) {
    double before = sqrt(product(system, j, j));
    for (size_t i = 0; i < j; i++) {
      if (size[i] == 0.0) continue;
      upper[i * (n + 1) + j] = product(system, i, j) / size[i];
      subtract(system, j, upper[i * (n + 1) + j], i);
    }
    size[j] = product(system, j, j);
    if (j < n && !(sqrt(size[j]) > SMALL * before)) {
      size[j] = 0.0;
      is_unique &= j >= needed;
    }
    if (j == n && !(sqrt(size[j]) <= SMALL * before)) is_unique = false;
  }
  for (size_t i = n; i-- > 0;) {
    solution[i] = size[i] == 0.0 ? 0.0 : upper[i * (n + 1) + n];
    for (size_t j = i + 1; j < n && size[i] != 0.0; j++) solution[i] -= upper[i * (n + 1) + j] * solution[j];
  }
  release(upper);
  release(size);
  return is_unique;
}
