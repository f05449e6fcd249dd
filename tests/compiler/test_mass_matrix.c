/* The factorization of large blocks of the mass matrix. */
#include "expressions.h"
#include "ldlt.h"

enum { SIZE = 30 };

/* A random positive definite matrix in packed storage. */
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
  assert_int_equal(ldlt_factor(SIZE, m), 0);
  ldlt_solve(SIZE, m, x);
  for (int i = 0; i < SIZE; i++) {
    double sum = 0.0;
    for (int j = 0; j < SIZE; j++) sum += original[i > j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i] * x[j];
    assert_true(fabs(sum - (i - 7.5)) < 1e-9);
  }
}

static void test_matrices_that_are_not_definite(void **state) {
  (void)state;
  double singular[] = {4.0, 2.0, 1.0}, negative[] = {1.0, 0.0, -1.0}, zero[] = {0.0}, nan[] = {NAN};
  assert_int_equal(ldlt_factor(2, singular), 2);
  assert_int_equal(ldlt_factor(2, negative), 2);
  assert_int_equal(ldlt_factor(1, zero), 1);
  assert_int_equal(ldlt_factor(1, nan), 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_solution),
      cmocka_unit_test(test_matrices_that_are_not_definite),
  };
  return cmocka_run_group_tests_name("mass matrix", tests, NULL, NULL);
}
