/* Forward and reverse differentiation of every operation, against each other and against difference quotients. */
#include "algebra/differentiate.h"
#include "base/memory.h"
#include "expressions.h"

static const char *const functions[] = {
    "x + y*z",    "x*y/z",      "x^3",         "x^-2.5",     "x^y",          "2^x",        "sqrt(x)",
    "sin(x*y)",   "cos(x - z)", "tan(x/2)",    "asin(x/3)",  "acos(y/3)",    "atan(x*z)",  "atan2(x, y)",
    "sinh(x)",    "cosh(y)",    "tanh(z)",     "asinh(x)",   "acosh(1 + x)", "atanh(x/4)", "exp(-x*y)",
    "log(x + y)", "min(x, y)",  "max(x*x, y)", "abs(y - z)", "sign(x)*x",    "pow(x, z)",  "1/(1 + x^2*y^2)",
};

/* Returns a difference quotient of fourth order. */
static double quotient(const struct Expressions *e, Node node, const double *at, int which) {
  static const double weights[] = {1.0, -8.0, 8.0, -1.0}, points[] = {-2, -1, 1, 2};
  const double h = 1e-3;
  double sum = 0.0;
  for (int i = 0; i < 4; i++) {
    double point[3] = {at[0], at[1], at[2]};
    point[which] += points[i] * h;
    sum += weights[i] * value_at(e, node, point[0], point[1], point[2]);
  }
  return sum / (12 * h);
}

static void test_every_operation(void **state) {
  (void)state;
  const double at[] = {0.8, 1.1, 0.6};
  for (size_t i = 0; i < sizeof functions / sizeof *functions; i++) {
    struct Expressions e = expressions_create();
    Node node = parse(&e, functions[i]), symbols[] = {e.x, e.y, e.z}, gradient[3];
    assert_int_equal(e.diagnostics.errors, 0);
    gradient_of(e.graph, node, COORDINATE, 3, gradient);
    for (int k = 0; k < 3; k++) {
      double reverse = value_at(&e, gradient[k], at[0], at[1], at[2]);
      double forward = value_at(&e, derivative_by(e.graph, node, symbols[k]), at[0], at[1], at[2]);
      double expected = quotient(&e, node, at, k);
      if (fabs(reverse - expected) > 1e-8 * (1 + fabs(expected)))
        fail_msg("d/d%c of %s is %g, expected %g", "xyz"[k], functions[i], reverse, expected);
      assert_true(fabs(forward - reverse) <= 1e-12 * (1 + fabs(reverse)));
    }
  }
}

static void test_directions_and_weights(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  Node targets[] = {parse(&e, "x*y"), parse(&e, "sin(z)*x")}, seeds[] = {parse(&e, "3"), parse(&e, "y"), ZERO};
  Node along[2], gradient[3], weights[] = {parse(&e, "y"), parse(&e, "2")};
  derivative_along(e.graph, targets, 2, seeds, along);
  assert_true(fabs(value_at(&e, along[0], 0.8, 1.1, 0.6) - (3 * 1.1 + 0.8 * 1.1)) < 1e-14);
  assert_true(fabs(value_at(&e, along[1], 0.8, 1.1, 0.6) - 3 * sin(0.6)) < 1e-14);
  weighted_gradient_of(e.graph, targets, weights, 2, COORDINATE, 3, gradient);
  assert_true(fabs(value_at(&e, gradient[0], 0.8, 1.1, 0.6) - (1.1 * 1.1 + 2 * sin(0.6))) < 1e-14);
  assert_true(fabs(value_at(&e, gradient[2], 0.8, 1.1, 0.6) - 2 * 0.8 * cos(0.6)) < 1e-14);
}

/* A gradient has exactly the symbols of its kinds that the target depends on. */
static void test_sparse_gradient(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  Node speed = scope_symbol(e.scope, VELOCITY, 0, "v", dimension_unknown, 1);
  Node node = multiply(e.graph, parse(&e, "x*z + sin(y - y)"), speed);
  struct Gradient all = gradient_by_kinds(e.graph, node, 1u << COORDINATE | 1u << VELOCITY);
  assert_int_equal(all.count, 3);
  assert_int_equal(all.symbols[0], e.x);
  assert_int_equal(all.symbols[1], e.z);
  assert_int_equal(all.symbols[2], speed);
  assert_int_equal(all.values[0], multiply(e.graph, e.z, speed));
  assert_int_equal(all.values[2], parse(&e, "x*z"));
  struct Gradient none = gradient_by_kinds(e.graph, node, 1u << INPUT);
  assert_int_equal(none.count, 0);
}

/* The gradient of sum x_i x_(i+1) has two terms for each element: its nodes grow as the sum does. */
static void test_long_sums(void **state) {
  (void)state;
  enum { LENGTH = 20000 };
  struct Expressions e = expressions_create();
  Node *x = allocate(LENGTH, sizeof *x), sum = ZERO;
  for (int i = 0; i < LENGTH; i++) x[i] = graph_symbol(e.graph, VELOCITY, i, "v");
  for (int i = 1; i < LENGTH; i++) sum = add(e.graph, sum, multiply(e.graph, x[i - 1], x[i]));
  size_t before = e.graph->count;
  struct Gradient gradient = gradient_by_kinds(e.graph, sum, 1u << VELOCITY);
  assert_int_equal(gradient.count, LENGTH);
  assert_int_equal(gradient.values[0], x[1]);
  for (int i = 1; i < LENGTH - 1; i++) assert_int_equal(gradient.values[i], add(e.graph, x[i - 1], x[i + 1]));
  assert_true(e.graph->count - before < 2 * LENGTH);
}

/* x (x+1) (x+2) ... nested: the derivative must not grow faster than the function. */
static void test_no_expression_swell(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  Node node = e.x;
  for (int i = 0; i < 200; i++) node = function(e.graph, SINE, multiply(e.graph, node, e.x), ZERO);
  size_t before = e.graph->count;
  derivative_by(e.graph, node, e.x);
  assert_true(e.graph->count - before < 4 * before);
}

/* x^p along x and p: a nonpositive base has a derivative if p is not varied; if p is, log(x) takes part. */
static void test_varied_exponents(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  Node p = graph_symbol(e.graph, PARAMETER, 0, "p"), seed = graph_symbol(e.graph, SEED_PARAMETER, 0, "seed of p");
  Node target = power(e.graph, e.x, p), along, seeds[] = {ONE, ZERO, ZERO, seed, ZERO};
  derivative_along(e.graph, &target, 1, seeds, &along);
  const struct {
    double x, p, seed, value;
  } cases[] = {{-2, 3, 0, 12},
               {0.5, 2, 1, 1 - 0.25 * 0.6931471805599453},
               {0.5, 2, -2, 1 + 0.5 * 0.6931471805599453},
               {3, 2, 0, 6}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    const double symbols[] = {cases[i].x, 0, 0, cases[i].p, cases[i].seed};
    double *values = graph_evaluate(e.graph, symbols);
    assert_true(fabs(values[along] - cases[i].value) < 1e-14);
  }
}

static void test_substitution(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  Node node = parse(&e, "x*sin(y) + z"), replacements[] = {parse(&e, "2"), ZERO, e.z}, result;
  substitute(e.graph, &node, 1, replacements, &result);
  assert_int_equal(result, e.z);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_every_operation),     cmocka_unit_test(test_directions_and_weights),
      cmocka_unit_test(test_sparse_gradient),     cmocka_unit_test(test_long_sums),
      cmocka_unit_test(test_no_expression_swell), cmocka_unit_test(test_substitution),
      cmocka_unit_test(test_varied_exponents),
  };
  return cmocka_run_group_tests_name("differentiate", tests, NULL, NULL);
}
