/* The LU factorizations of implicit methods, dense and sparse, against products with known vectors. */
#include "support/lu.h"

#include "expressions.h"
#include "mechanics/mass_matrix/elimination.h"

enum { SIZE = 30, POSITIONS = SIZE * (SIZE + 1) / 2, NUMBERS = COMPLEX * (SIZE * SIZE + SIZE) };

static int slot[SIZE], start[SIZE + 1], column[POSITIONS];
const struct Lagrangian lagrangian = {
    .coordinate_count = SIZE, .state_count = 2 * SIZE, .implicit = {.lu_pattern = {slot, start, column}}};

/* Returns a random number from -1 to 1. */
static double next(unsigned *seed) {
  *seed = *seed * 1103515245u + 12345u;
  return (double)(*seed >> 16) / 32768.0 - 1.0;
}

static void set_pattern(const struct Position *positions, size_t count) {
  struct Graph *graph = graph_create();
  struct Elimination elimination = eliminate(graph, SIZE, NULL, positions, count);
  for (size_t i = 0; i < SIZE; i++) slot[elimination.order[i]] = (int)i;
  for (size_t i = 0; i <= SIZE; i++) start[i] = (int)elimination.start[i];
  for (size_t k = 0; k < elimination.start[SIZE]; k++) column[k] = (int)elimination.column[k];
}

/* Sets an element of a matrix, and adds its product with x to the right side. */
static void set(const struct Lu *lu, size_t width, size_t i, size_t j, const double *value, double *matrix,
                const double *x, double *right) {
  memcpy(matrix + width * lu->slot(i, j), value, width * sizeof *value);
  number_add_product(width, right + width * i, value, x + width * j);
}

/* Returns the largest error of the solution for a random matrix with this diagonal. */
static double error_of(const struct Lu *lu, size_t width, const struct Position *positions, size_t count,
                       double diagonal) {
  double matrix[NUMBERS] = {0}, x[COMPLEX * SIZE], right[COMPLEX * SIZE] = {0}, work[2 * COMPLEX * SIZE], error = 0.0;
  unsigned seed = 3;
  assert_true(lu->size(width) <= NUMBERS);
  for (size_t i = 0; i < COMPLEX * SIZE; i++) x[i] = next(&seed);
  for (size_t k = 0; k < count; k++) {
    size_t i = positions[k].row, j = positions[k].column;
    double lower[] = {next(&seed), next(&seed)}, upper[] = {next(&seed), next(&seed)};
    if (i == j) lower[0] += diagonal;
    set(lu, width, i, j, lower, matrix, x, right);
    if (i != j) set(lu, width, j, i, upper, matrix, x, right);
  }
  assert_true(lu->factor(width, matrix, work));
  lu->solve(width, matrix, right, work);
  for (size_t i = 0; i < width * SIZE; i++) error = fmax(error, fabs(right[i] - x[i]));
  return error;
}

static void test_solutions(void **state) {
  (void)state;
  unsigned seed = 11;
  for (int share = 0; share <= 100; share += 10) {
    struct Position positions[POSITIONS];
    size_t count = 0;
    for (size_t i = 0; i < SIZE; i++)
      for (size_t j = 0; j <= i; j++)
        if (i == j || 50.0 * (next(&seed) + 1.0) < share) positions[count++] = (struct Position){i, j};
    set_pattern(positions, count);
    for (size_t width = REAL; width <= COMPLEX; width++) {
      assert_true(error_of(&lu_sparse, width, positions, count, 20.0) < 1e-14);
      assert_true(error_of(&lu_dense, width, positions, count, 20.0) < 1e-14);
      if (share == 100) assert_true(error_of(&lu_dense, width, positions, count, 0.0) < 1e-11);
    }
  }
}

/* Factors the unit matrix with two rows and columns changed. Returns false if that fails. */
static bool factors(const struct Lu *lu, size_t width, double a, double b, double c, double d) {
  double matrix[NUMBERS] = {0}, work[2 * COMPLEX * SIZE];
  for (size_t i = 0; i < SIZE; i++) matrix[width * lu->slot(i, i)] = 1.0;
  matrix[width * lu->slot(7, 7)] = a;
  matrix[width * lu->slot(7, 8)] = b;
  matrix[width * lu->slot(8, 7)] = c;
  matrix[width * lu->slot(8, 8)] = d;
  return lu->factor(width, matrix, work);
}

/* Without row pivoting, a pivot without correct digits must be rejected. */
static void test_pivots_that_are_lost(void **state) {
  (void)state;
  struct Position positions[2 * SIZE];
  size_t count = 0;
  for (size_t i = 0; i < SIZE; i++) {
    positions[count++] = (struct Position){i, i};
    if (i > 0) positions[count++] = (struct Position){i, i - 1};
  }
  set_pattern(positions, count);
  for (size_t width = REAL; width <= COMPLEX; width++) {
    assert_true(factors(&lu_dense, width, 0, 1, 1, 0) && !factors(&lu_sparse, width, 0, 1, 1, 0));
    assert_true(factors(&lu_dense, width, 1e-9, 1, 1, 1e-9) && !factors(&lu_sparse, width, 1e-9, 1, 1, 1e-9));
    assert_true(factors(&lu_dense, width, 1e-9, 1, 1, 1) && factors(&lu_sparse, width, 1e-9, 1, 1, 1));
    assert_true(!factors(&lu_dense, width, 1, 1, 1, 1) && !factors(&lu_sparse, width, 1, 1, 1, 1));
    assert_true(!factors(&lu_sparse, width, 1, 1, 1, 1 + 4e-16));
    assert_true(!factors(&lu_dense, width, 1, NAN, 1, 1) && !factors(&lu_sparse, width, 1, NAN, 1, 1));
    assert_true(!factors(&lu_dense, width, INFINITY, 1, 1, 1) && !factors(&lu_sparse, width, 1, 1, 1, INFINITY));
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_solutions),
      cmocka_unit_test(test_pivots_that_are_lost),
  };
  return cmocka_run_group_tests_name("LU factors", tests, NULL, NULL);
}
