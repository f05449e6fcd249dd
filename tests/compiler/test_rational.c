/* Fractions of polynomials: they cancel common factors, and give up where a value would change. */
#include "expressions.h"
#include "algebra/polynomials/rational.h"

static Node fraction(struct Expressions *e, const char *text) {
  return simplify_fraction(e->graph, parse(e, text));
}

/* Products are expanded before like terms combine; 0.1 + 0.2 - 0.3 is 5.6e-17 in doubles. */
static void test_rounding_errors_of_zero(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  assert_int_equal(fraction(&e, "y*(0.1*x + 1) + y*(0.2*x + 1) - y*(0.3*x + 2)"), ZERO);
  Node small = fraction(&e, "y*(x + 1) - y*(0.999*x + 1)"), smaller = fraction(&e, "y*(x + 1) - y*(0.999999999*x + 1)");
  assert_true(fabs(value_at(&e, small, 2, 3, 0) - 6e-3) < 1e-14);
  assert_true(fabs(value_at(&e, smaller, 2, 3, 0) - 6e-9) < 1e-14);
}

/* Exponents are limited to 255, coefficients where they lose digits, polynomials to 400 terms. */
static void test_limits_keep_values(void **state) {
  (void)state;
  static const struct {
    const char *text;
    double x, y, z, value;
  } cases[] = {
      {"(x^20*y)^20", 1.01, 1, 0, 53.52411720829438},             /* 1.01^400 */
      {"(x^20*y)^13*z", 1.01, 2, 3, 3 * 8192 * 13.2909854780554}, /* 1.01^260 */
      {"(1e-200*x + y)*(1e-200*x - y)", 1e200, 0.5, 0, 0.75},
      {"(1e200*x + y)*(1e200*x - y)", 1e-200, 0.5, 0, 0.75},
      {"(1 + x + y + z)^20 - (1 + x + y)^20", 0.5, -0.5, 0.25, 85.73617379884035}, /* 1.25^20 - 1 */
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct Expressions e = expressions_create();
    double value = value_at(&e, fraction(&e, cases[i].text), cases[i].x, cases[i].y, cases[i].z);
    if (!(fabs(value - cases[i].value) <= 1e-12 * fabs(cases[i].value))) fail_msg("%s is %.17g", cases[i].text, value);
  }
}

static void test_large_polynomials_stay_as_they_are(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  static const char *const texts[] = {"(1 + x + y + z)^20 - x", "(x + 1)^21 + y"};
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
    Node node = parse(&e, texts[i]);
    assert_int_equal(simplify_fraction(e.graph, node), node);
  }
}

/* An expression that vanishes only when expanded has no reciprocal; the rest is reduced to lowest terms. */
static void test_reciprocal_of_zero(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  Node node = fraction(&e, "(z^2 - 1)/(z - 1) + ((x + y)^2 - x^2 - 2*x*y - y^2)^-1");
  char *text = expression_text(e.graph, node);
  assert_null(strstr(text, "z^2"));
  assert_non_null(strstr(text, "1/"));
}

static void test_lowest_terms(void **state) {
  (void)state;
  static const char *const cases[][2] = {
      {"(x^2 - y^2)/(x - y)", "x + y"},     {"(x - y)/(x^2 - y^2)", "1/(x + y)"},
      {"x/(x*y + x*z)", "1/(y + z)"},       {"(x*y + x*z)/(x*x)", "(y + z)/x"},
      {"(x^3 - 1)/(x - 1)", "x^2 + x + 1"}, {"x/(2*y) + x/(2*y)", "x/y"},
      {"1/(x + y) - 1/(x + y)", "0"},       {"(x + y)*(x - y) + y^2", "x^2"},
      {"(2*x*y + 4*y)/(2*y)", "x + 2"},     {"x/(1/y)", "x*y"},
      {"(1/x)/(1/x + 1/y)", "y/(x + y)"},   {"(x/y)^-2*x", "y^2/x"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct Expressions e = expressions_create();
    Node node = fraction(&e, cases[i][0]), expected = parse(&e, cases[i][1]);
    if (node != expected) {
      char *text = expression_text(e.graph, node);
      fail_msg("%s gives %s, expected %s", cases[i][0], text, cases[i][1]);
    }
  }
}

/* A sum has more different functions than a polynomial may have atoms. */
static void test_many_atoms(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  Node sum = ZERO;
  double expected = 0.0;
  for (int i = 1; i <= 40; i++) {
    Node term = multiply(e.graph, function(e.graph, SINE, scale(e.graph, i, e.x), ZERO), e.y);
    sum = add(e.graph, sum, multiply(e.graph, term, term));
    expected += 4.0 * sin(0.7 * i) * sin(0.7 * i);
  }
  assert_true(fabs(value_at(&e, simplify_fraction(e.graph, sum), 0.7, 2, 0) - expected) < 1e-10);
}

enum { SIZE = 3 };

/* matrix * solution = right side, for two right sides, for numeric values. */
static void test_linear_equations(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  static const char *const texts[SIZE][SIZE + 2] = {{"x + y", "x", "0", "1", "x"},
                                                    {"x", "x + y + z", "-y*x", "y/z", "0"},
                                                    {"0", "-y*x", "4 + y^2", "-2", "1/(x + y)"}};
  Node matrix[SIZE * SIZE], right[SIZE * 2], solution[SIZE * 2];
  for (int i = 0; i < SIZE; i++) {
    for (int j = 0; j < SIZE; j++) matrix[i * SIZE + j] = parse(&e, texts[i][j]);
    for (int j = 0; j < 2; j++) right[i * 2 + j] = parse(&e, texts[i][SIZE + j]);
  }
  assert_true(solve_fractions(e.graph, SIZE, matrix, 2, right, solution));
  for (int i = 0; i < SIZE; i++)
    for (int j = 0; j < 2; j++) {
      double sum = -value_at(&e, right[i * 2 + j], 0.7, 1.3, 2.9);
      for (int k = 0; k < SIZE; k++)
        sum += value_at(&e, matrix[i * SIZE + k], 0.7, 1.3, 2.9) * value_at(&e, solution[k * 2 + j], 0.7, 1.3, 2.9);
      assert_true(fabs(sum) < 1e-12);
    }
}

static void test_singular_equations(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  Node zero = parse(&e, "(x + y)^2 - x^2 - 2*x*y - y^2"), right[] = {ONE, ONE}, solution[2];
  const Node pair[] = {e.x, e.y, parse(&e, "2*x"), parse(&e, "2*y")};
  assert_false(solve_fractions(e.graph, 1, &zero, 1, right, solution));
  assert_false(solve_fractions(e.graph, 2, pair, 1, right, solution));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_rounding_errors_of_zero),
      cmocka_unit_test(test_limits_keep_values),
      cmocka_unit_test(test_large_polynomials_stay_as_they_are),
      cmocka_unit_test(test_reciprocal_of_zero),
      cmocka_unit_test(test_lowest_terms),
      cmocka_unit_test(test_many_atoms),
      cmocka_unit_test(test_linear_equations),
      cmocka_unit_test(test_singular_equations),
  };
  return cmocka_run_group_tests_name("rational", tests, NULL, NULL);
}
