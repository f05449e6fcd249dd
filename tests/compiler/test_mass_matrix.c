/* The numeric factorization of blocks of the mass matrix. */
#include "expressions.h"
#include "ldlt.h"
#include "mechanics/mass_matrix/elimination.h"

enum { SIZE = 30 };

/* Fills a random positive definite matrix in packed storage. */
static void random_matrix(double m[SIZE * (SIZE + 1) / 2]) {
  double factor[SIZE][SIZE];
  unsigned seed = 5;
  for (int i = 0; i < SIZE; i++)
    for (int j = 0; j < SIZE; j++) {
      seed = seed * 1103515245u + 12345u;
      factor[i][j] = (double)(seed >> 16) / 65536.0 - 0.5;
    }
  for (int i = 0; i < SIZE; i++)
    for (int j = 0; j <= i; j++) {
      double sum = i == j ? 0.1 : 0.0;
      for (int k = 0; k < SIZE; k++) sum += factor[i][k] * factor[j][k];
      m[i * (i + 1) / 2 + j] = sum;
    }
}

static void test_solution(void **state) {
  (void)state;
  double m[SIZE * (SIZE + 1) / 2], original[SIZE * (SIZE + 1) / 2], x[SIZE];
  random_matrix(m);
  memcpy(original, m, sizeof m);
  for (int i = 0; i < SIZE; i++) x[i] = i - 7.5;
  assert_int_equal(ldlt_factor(SIZE, NULL, NULL, m), 0);
  ldlt_solve(SIZE, NULL, NULL, m, x);
  for (int i = 0; i < SIZE; i++) {
    double sum = 0.0;
    for (int j = 0; j < SIZE; j++) sum += original[i > j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i] * x[j];
    assert_true(fabs(sum - (i - 7.5)) < 1e-9);
  }
}

static void test_matrices_that_are_not_definite(void **state) {
  (void)state;
  double singular[] = {4.0, 2.0, 1.0}, negative[] = {1.0, 0.0, -1.0}, zero[] = {0.0}, nan[] = {NAN};
  assert_int_equal(ldlt_factor(2, NULL, NULL, singular), 2);
  assert_int_equal(ldlt_factor(2, NULL, NULL, negative), 2);
  assert_int_equal(ldlt_factor(1, NULL, NULL, zero), 1);
  assert_int_equal(ldlt_factor(1, NULL, NULL, nan), 1);
}

/*
 * Pivots that consist of rounding errors, of either sign, are rejected; small ones with correct digits are not.
 * Matrices by rows of the lower triangle.
 */
static void test_pivots_near_zero(void **state) {
  (void)state;
  const size_t start[] = {0, 1, 3}, column[] = {0, 0, 1};
  for (int i = 1; i <= 200; i++) {
    double a = 1.0 / 3, b = i / 7.0, full[] = {a * a, a * b, b * b}, sparse[] = {a * a, a * b, b * b};
    assert_int_equal(ldlt_factor(2, NULL, NULL, full), 2);
    assert_int_equal(ldlt_factor(2, start, column, sparse), 2);
  }
  double full[] = {1.0, 1.0, 1.0 + 1e-9}, sparse[] = {1.0, 1.0, 1.0 + 1e-9}, x[] = {0.0, 1e-9}, y[] = {0.0, 1e-9};
  assert_int_equal(ldlt_factor(2, NULL, NULL, full), 0);
  assert_int_equal(ldlt_factor(2, start, column, sparse), 0);
  ldlt_solve(2, NULL, NULL, full, x);
  ldlt_solve(2, start, column, sparse, y);
  assert_true(fabs(x[0] + 1) < 1e-6 && fabs(x[1] - 1) < 1e-6 && fabs(y[0] + 1) < 1e-6 && fabs(y[1] - 1) < 1e-6);
}

enum { SPARSE = 40, POSITIONS = SPARSE * (SPARSE + 1) / 2 };

static unsigned next(unsigned *seed) {
  *seed = *seed * 1103515245u + 12345u;
  return *seed >> 16;
}

/* Solves by Gaussian elimination of the full matrix, which is overwritten. */
static void solve_by_gauss(size_t n, double m[SPARSE][SPARSE], double *x) {
  for (size_t k = 0; k < n; k++)
    for (size_t i = k + 1; i < n; i++) {
      double factor = m[i][k] / m[k][k];
      for (size_t j = k; j < n; j++) m[i][j] -= factor * m[k][j];
      x[i] -= factor * x[k];
    }
  for (size_t i = n; i-- > 0;) {
    for (size_t j = i + 1; j < n; j++) x[i] -= m[i][j] * x[j];
    x[i] /= m[i][i];
  }
}

/* Compares the sparse factorization with elimination of the full matrix. Returns the number of elements of L. */
static size_t check_sparse(size_t n, const struct Position *positions, size_t count, unsigned seed) {
  double full[SPARSE][SPARSE] = {{0}}, m[POSITIONS] = {0}, x[SPARSE], expected[SPARSE];
  struct Graph *graph = graph_create();
  struct Elimination elimination = eliminate(graph, n, NULL, positions, count);
  size_t index[SPARSE], *start = elimination.start, *column = elimination.column;
  for (size_t i = 0; i < n; i++) index[elimination.order[i]] = i;
  for (size_t k = 0; k < count; k++) {
    size_t i = positions[k].row, j = positions[k].column;
    double value = i == j ? 2.0 * SPARSE : (double)next(&seed) / 32768.0 - 1.0;
    full[i][j] = full[j][i] = value;
    size_t row = index[i] > index[j] ? index[i] : index[j], found = start[row];
    while (found < start[row + 1] && column[found] != (index[i] < index[j] ? index[i] : index[j])) found++;
    assert_true(found < start[row + 1]);
    m[found] = value;
  }
  for (size_t i = 0; i < n; i++) x[index[i]] = expected[i] = (double)i - 7.5;
  solve_by_gauss(n, full, expected);
  assert_int_equal(ldlt_factor(n, start, column, m), 0);
  ldlt_solve(n, start, column, m, x);
  for (size_t i = 0; i < n; i++) assert_true(fabs(x[index[i]] - expected[i]) < 1e-13);
  size_t elements = start[n];
  return elements;
}

static void test_sparse_patterns(void **state) {
  (void)state;
  unsigned seed = 11;
  for (size_t n = 1; n <= SPARSE; n++)
    for (unsigned share = 0; share <= 100; share += 10) {
      struct Position positions[POSITIONS];
      size_t count = 0;
      for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++)
          if (i == j || next(&seed) % 100 < share) positions[count++] = (struct Position){i, j};
      check_sparse(n, positions, count, seed);
    }
}

/* A chain, a star and a tree have no fill-in; a full matrix keeps its order. */
static void test_order_of_elimination(void **state) {
  (void)state;
  struct Position chain[2 * SPARSE], star[2 * SPARSE], tree[2 * SPARSE], full[POSITIONS];
  size_t count = 0, all = 0;
  for (size_t i = 0; i < SPARSE; i++) {
    chain[count] = star[count] = tree[count] = (struct Position){i, i};
    count++;
    for (size_t j = 0; j <= i; j++) full[all++] = (struct Position){i, j};
    if (i == 0) continue;
    chain[count] = (struct Position){i, i - 1};
    star[count] = (struct Position){i, 0};
    tree[count++] = (struct Position){i, (i - 1) / 2};
  }
  assert_int_equal(check_sparse(SPARSE, chain, count, 1), count);
  assert_int_equal(check_sparse(SPARSE, star, count, 2), count);
  assert_int_equal(check_sparse(SPARSE, tree, count, 3), count);
  struct Graph *graph = graph_create();
  struct Elimination elimination = eliminate(graph, SPARSE, NULL, full, all);
  for (size_t i = 0; i < SPARSE; i++) assert_int_equal(elimination.order[i], i);
}

static void test_sparse_matrices_that_are_not_definite(void **state) {
  (void)state;
  const size_t start[] = {0, 1, 2, 5}, column[] = {0, 1, 0, 1, 2};
  double singular[] = {1.0, 1.0, 1.0, 1.0, 2.0}, negative[] = {1.0, -1.0, 1.0, 1.0, 9.0}, nan[] = {1.0, 1.0, NAN, 0, 2};
  assert_int_equal(ldlt_factor(3, start, column, singular), 3);
  assert_int_equal(ldlt_factor(3, start, column, negative), 2);
  assert_int_equal(ldlt_factor(3, start, column, nan), 3);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_solution),
      cmocka_unit_test(test_matrices_that_are_not_definite),
      cmocka_unit_test(test_pivots_near_zero),
      cmocka_unit_test(test_sparse_patterns),
      cmocka_unit_test(test_order_of_elimination),
      cmocka_unit_test(test_sparse_matrices_that_are_not_definite),
  };
  return cmocka_run_group_tests_name("mass matrix", tests, NULL, NULL);
}
