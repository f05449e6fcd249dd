/* Every row of the table of operations is complete and correct, against long doubles and difference quotients. */
#include "algebra/functions.h"

#include "algebra/differentiate.h"
#include "expressions.h"
#include "random_numbers.h"

typedef long double OfOne(long double);
typedef long double OfTwo(long double, long double);

static long double sum_of(long double a, long double b) {
  return a + b;
}

static long double product_of_two(long double a, long double b) {
  return a * b;
}

static long double one_if_less(long double a, long double b) {
  return a < b ? 1.0L : 0.0L;
}

static long double if_positive(long double x, long double y) {
  return x > 0 ? y : 0;
}

/* Random numbers have tests of their own, against published vectors. */
static long double uniform_of(long double seed, long double k) {
  return random_uniform((double)seed, (double)k);
}

static long double gauss_of(long double seed, long double k) {
  return random_gauss((double)seed, (double)k);
}

static long double logistic_of(long double u) {
  return 1 / (1 + expl(-u));
}

static long double softplus_of(long double u) {
  return logl(1 + expl(u));
}

static long double sech_of(long double u) {
  return 1 / coshl(u);
}

static long double log_cosh_of(long double u) {
  return logl(coshl(u));
}

static long double sign_of(long double x) {
  return x == 0 ? 0 : copysignl(1.0L, x);
}

/*
 * C's own functions, by their names in the language and in C (NULL if it is an expression), and their step limits.
 * auxiliary_limit: the function has a singularity, or its domain ends, where the auxiliary is 0. operand_limit: for
 * complex operands, the function grows like exp or has poles. Other functions depend on roots or such functions, which
 * have limits themselves, or are sine and cosine, which need none.
 */
static const struct Reference {
  const char *name, *c_name;
  OfOne *of_one;
  OfTwo *of_two;
  const char *operand_limit, *auxiliary_limit;
} references[] = {
    {"add", NULL, NULL, sum_of, NULL, NULL},
    {"multiply", NULL, NULL, product_of_two, NULL, NULL},
    {"pow", "pow", NULL, powl, NULL, NULL},
    {"atan2", "atan2", NULL, atan2l, NULL, "positive"},
    {"min", "fmin", NULL, fminl, NULL, "sign"},
    {"max", "fmax", NULL, fmaxl, NULL, "sign"},
    {"less", NULL, NULL, one_if_less, NULL, "sign"},
    {"gate", NULL, NULL, if_positive, NULL, NULL},
    {"sin", "sin", sinl, NULL, NULL, NULL},
    {"cos", "cos", cosl, NULL, NULL, NULL},
    {"tan", "tan", tanl, NULL, "tangent", NULL},
    {"asin", "asin", asinl, NULL, NULL, NULL},
    {"acos", "acos", acosl, NULL, NULL, NULL},
    {"atan", "atan", atanl, NULL, NULL, "positive"},
    {"sinh", "sinh", sinhl, NULL, "hyperbolic", NULL},
    {"cosh", "cosh", coshl, NULL, "hyperbolic", NULL},
    {"tanh", "tanh", tanhl, NULL, "tanh", NULL},
    {"asinh", "asinh", asinhl, NULL, NULL, "positive"},
    {"acosh", "acosh", acoshl, NULL, NULL, NULL},
    {"atanh", "atanh", atanhl, NULL, NULL, "positive"},
    {"exp", "exp", expl, NULL, "exponential", NULL},
    {"log", "log", logl, NULL, NULL, "positive"},
    {"1/(1 + exp)", "logistic", logistic_of, NULL, "bounded", NULL},
    {"log(1 + exp)", "softplus", softplus_of, NULL, "bounded", NULL},
    {"1/cosh", "sech", sech_of, NULL, "bounded", NULL},
    {"log(cosh)", "log_cosh", log_cosh_of, NULL, "bounded", NULL},
    {"exp(min)", "capped_exp", expl, NULL, "bounded", NULL},
    {"exp(min)'", "capped_exp_slope", expl, NULL, "bounded", NULL},
    {"abs", "fabs", fabsl, NULL, NULL, "sign"},
    {"sign", NULL, sign_of, NULL, NULL, "sign"},
    {"floor", NULL, floorl, NULL, NULL, NULL},
    {"uniform", "random_uniform", NULL, uniform_of, NULL, NULL},
    {"gauss", "random_gauss", NULL, gauss_of, NULL, NULL},
};

static const double points[] = {-2.7, -1.9, -1.3, -0.95, -0.6, -0.2, 0.25, 0.55, 0.9, 1.4, 2.1, 2.8};
enum { POINTS = sizeof points / sizeof *points };

static bool is_leaf(enum Operation operation) {
  return operation == CONSTANT || operation == SYMBOL;
}

static const struct Reference *reference_of(enum Operation operation) {
  const char *name = operation_name(operation);
  if (name == NULL) fail_msg("operation %d has no row", (int)operation);
  for (size_t i = 0; i < sizeof references / sizeof *references; i++)
    if (strcmp(references[i].name, name) == 0) return &references[i];
  fail_msg("no reference for '%s'; expected one here", name);
  return NULL;
}

static long double value(const struct Reference *reference, long double left, long double right) {
  return reference->of_one != NULL ? reference->of_one(left) : reference->of_two(left, right);
}

/* Returns a difference quotient of fourth order along one operand. */
static double slope(const struct Reference *reference, double left, double right, int which) {
  static const long double weights[] = {1, -8, 8, -1}, steps[] = {-2, -1, 1, 2}, h = 1e-5L;
  long double sum = 0;
  for (int i = 0; i < 4; i++)
    sum +=
        weights[i] * value(reference, left + (which == 0 ? steps[i] * h : 0), right + (which == 1 ? steps[i] * h : 0));
  return (double)(sum / (12 * h));
}

static void assert_near(double found, double expected, const char *what, enum Operation operation, double x, double y) {
  if (!(fabs(found - expected) <= 1e-11 * (1 + fabs(expected))))
    fail_msg("%s of %s at (%g, %g) is %.17g, expected %.17g", what, operation_name(operation), x, y, found, expected);
}

/* Calls test for each operation, at pairs of values in its domain. */
static void at_points(void (*test)(struct Expressions *e, Node node, double x, double y)) {
  for (enum Operation operation = 0; operation < OPERATION_COUNT; operation++) {
    if (is_leaf(operation)) continue;
    const struct Reference *reference = reference_of(operation);
    struct Expressions e = expressions_create();
    Node node = graph_node(e.graph, operation, e.x, reference->of_two != NULL ? e.y : ZERO);
    int tested = 0;
    for (int i = 0; i < POINTS; i++) {
      for (int j = 0; j < POINTS; j++) {
        if (i == j || isnan(value(reference, points[i], points[j]))) continue;
        test(&e, node, points[i], points[j]);
        tested++;
      }
    }
    assert_true(tested > POINTS);
  }
}

static void test_every_row_is_complete(void **state) {
  (void)state;
  for (enum Operation operation = 0; operation < OPERATION_COUNT; operation++) {
    const struct Function *row = &functions[operation];
    if (row->name == NULL) fail_msg("operation %d has no row", (int)operation);
    for (enum Operation other = 0; other < operation; other++)
      assert_string_not_equal(row->name, functions[other].name);
    int given = (row->of_one != NULL) + (row->of_two != NULL);
    assert_int_equal(given, is_leaf(operation) ? 0 : 1);
    bool gives_derivative = row->recurrence == INTEGRAL || row->recurrence == RATIO;
    bool has_derivative = gives_derivative || row->recurrence == PIECEWISE_CONSTANT || is_leaf(operation);
    if (has_derivative != (row->partial_derivatives == NULL))
      fail_msg("%s: expected a recurrence that gives its derivative, or partial derivatives", row->name);
    if (gives_derivative) assert_true(row->of_one != NULL);
    else assert_false(row->is_reversed);
    if (row->recurrence != ARITHMETIC && row->auxiliary == NULL) fail_msg("%s has no auxiliary", row->name);
    bool is_arithmetic = is_leaf(operation) || operation == ADD || operation == MULTIPLY || operation == POWER;
    if ((row->recurrence == ARITHMETIC) != is_arithmetic) fail_msg("%s has no recurrence", row->name);
    if ((row->domain.kind == EVERYWHERE) == (row->domain.low < row->domain.high))
      fail_msg("%s: expected a domain and its ends, or neither", row->name);
    if (row->domain.kind != EVERYWHERE && row->domain_text == NULL) fail_msg("%s has no domain's text", row->name);
    assert_true((row->fold_name != NULL) == (row->folded[0] != CONSTANT));
  }
}

static void assert_same_text(const char *found, const char *expected, const char *what, enum Operation operation) {
  bool is_same = found == NULL || expected == NULL ? found == expected : strcmp(found, expected) == 0;
  if (!is_same) fail_msg("%s of %s is wrong", what, operation_name(operation));
}

static void test_names_in_c_and_limits(void **state) {
  (void)state;
  for (enum Operation operation = 0; operation < OPERATION_COUNT; operation++) {
    if (is_leaf(operation)) continue;
    const struct Function *row = &functions[operation];
    const struct Reference *reference = reference_of(operation);
    if (reference->c_name != NULL)
      assert_same_text(function_in_c(operation), reference->c_name, "the name in C", operation);
    assert_same_text(row->operand_limit, reference->operand_limit, "the limit by the operand", operation);
    assert_same_text(row->auxiliary_limit, reference->auxiliary_limit, "the limit by the auxiliary", operation);
  }
}

/*
 * A call with the right number of arguments gives this operation. One argument less or more is an error, and so is a
 * varying seed.
 */
static void test_the_language_follows(void **state) {
  (void)state;
  for (enum Operation operation = 0; operation < OPERATION_COUNT; operation++) {
    struct Expressions e = expressions_create();
    const char *name = operation_name(operation);
    if (strchr(name, '(') != NULL || strchr(name, '/') != NULL) continue; /* internal: a formula as name */
    char one[40], two[40];
    snprintf(one, sizeof one, "%s(x)", name);
    snprintf(two, sizeof two, "%s(x, y)", name);
    bool is_internal = is_leaf(operation) || operation == UNIFORM || operation == GAUSS || operation == ADD ||
                       operation == MULTIPLY || operation == LESS || operation == GUARD;
    bool has_two = operation_arity(operation) == 2;
    Node first = parse(&e, one);
    assert_int_equal(e.diagnostics.errors, is_internal || has_two ? 1 : 0);
    if (e.diagnostics.errors == 0) assert_int_equal(e.graph->vertices[first].operation, operation);
    e.diagnostics.errors = 0;
    Node second = parse(&e, two);
    assert_int_equal(e.diagnostics.errors, is_internal || !has_two ? 1 : 0);
    if (e.diagnostics.errors == 0) assert_int_equal(e.graph->vertices[second].operation, operation);
  }
}

static void check_value(struct Expressions *e, Node node, double x, double y) {
  enum Operation operation = e->graph->vertices[node].operation;
  double expected = (double)value(reference_of(operation), x, y);
  double found = operation_evaluate(operation, x, y);
  if (!(fabs(found - expected) <= 4e-16 * (1 + fabs(expected))))
    assert_near(found, expected, "the value", operation, x, y);
  assert_near(value_at(e, node, x, y, 0), expected, "the value", operation, x, y);
}

static void test_values(void **state) {
  (void)state;
  at_points(check_value);
}

static void check_derivative(struct Expressions *e, Node node, double x, double y) {
  enum Operation operation = e->graph->vertices[node].operation;
  const struct Reference *reference = reference_of(operation);
  double by_x = value_at(e, derivative_by(e->graph, node, e->x), x, y, 0);
  assert_near(by_x, slope(reference, x, y, 0), "the derivative", operation, x, y);
  /* a negative base has no derivative along its exponent */
  if (reference->of_one != NULL || (operation == POWER && x < 0)) return;
  double by_y = value_at(e, derivative_by(e->graph, node, e->y), x, y, 0);
  assert_near(by_y, slope(reference, x, y, 1), "the derivative", operation, x, y);
}

static void test_derivatives(void **state) {
  (void)state;
  at_points(check_derivative);
}

/* Checks the equation of enum Recurrence. */
static void check_recurrence(struct Expressions *e, Node node, double x, double y) {
  enum Operation operation = e->graph->vertices[node].operation;
  const struct Function *row = &functions[operation];
  const struct Reference *reference = reference_of(operation);
  if (row->recurrence == ARITHMETIC || row->recurrence == GUARDED) return;
  double a = value_at(e, row->auxiliary(e->graph, node), x, y, 0), sign = (a > 0) - (a < 0);
  double by_x = slope(reference, x, y, 0), here = (double)value(reference, x, y);
  switch (row->recurrence) {
  case INTEGRAL: assert_near(recurrence_sign(row) * a, by_x, "sign a", operation, x, y); return;
  case RATIO: assert_near(recurrence_sign(row) / a, by_x, "sign / a", operation, x, y); return;
  case ANGLE:
    assert_near(a * by_x, y, "a by y", operation, x, y);
    assert_near(a * slope(reference, x, y, 1), -x, "a by x", operation, x, y);
    return;
  case REFLECTION: assert_near(sign * x, here, "the piece", operation, x, y); return;
  case CHOICE: {
    bool is_first = operation == MAXIMUM ? a > 0 : a < 0;
    assert_near(is_first ? x : y, here, "the piece", operation, x, y);
    return;
  }
  case PIECEWISE_CONSTANT:
    assert_near(0, by_x, "the slope", operation, x, y);
    if (operation == LESS || operation == SIGN)
      assert_near(operation == LESS ? a < 0 : sign, here, "the piece", operation, x, y);
    return;
  case GUARDED:
  case ARITHMETIC: return;
  }
}

static void test_recurrences(void **state) {
  (void)state;
  at_points(check_recurrence);
}

static void test_auxiliaries_of_powers(void **state) {
  (void)state;
  static const struct {
    const char *power, *auxiliary; /* NULL for none */
  } cases[] = {{"x^6", "x^3"},      {"x^5", "x^4"},      {"x^(-3)", "x^3"}, {"1/sqrt(x)", "sqrt(x)"},
               {"x^y", "y*log(x)"}, {"2^x", "x*log(2)"}, {"x^2.5", NULL},   {"x^2", NULL}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct Expressions e = expressions_create();
    Node node = parse(&e, cases[i].power), auxiliary = functions[POWER].auxiliary(e.graph, node);
    assert_int_equal(e.graph->vertices[node].operation, POWER);
    if (cases[i].auxiliary == NULL) assert_int_equal(auxiliary, ZERO);
    else
      assert_near(value_at(&e, auxiliary, 1.7, 2.3, 0), value_at(&e, parse(&e, cases[i].auxiliary), 1.7, 2.3, 0),
                  cases[i].power, POWER, 1.7, 2.3);
  }
}

/* A function is odd if it changes its sign with its argument at all tested values, and even if it keeps its value. */
static void test_parity_and_sign(void **state) {
  (void)state;
  for (enum Operation operation = 0; operation < OPERATION_COUNT; operation++) {
    if (is_leaf(operation) || functions[operation].recurrence == ARITHMETIC) continue;
    const struct Reference *reference = reference_of(operation);
    bool is_odd = reference->of_one != NULL, is_even = is_odd, is_never_negative = true;
    for (int i = 0; i < POINTS; i++) {
      for (int j = 0; j < POINTS; j++) {
        long double here = value(reference, points[i], points[j]), there = value(reference, -points[i], points[j]);
        is_never_negative = is_never_negative && !(here < 0);
        if (isnan(here) && isnan(there)) continue;
        is_odd = is_odd && fabsl(here + there) < 1e-15L;
        is_even = is_even && fabsl(here - there) < 1e-15L;
      }
    }
    if (functions[operation].parity != (is_odd ? ODD : is_even ? EVEN : NEITHER_ODD_NOR_EVEN))
      fail_msg("the parity of %s is wrong", operation_name(operation));
    if (functions[operation].is_never_negative != is_never_negative)
      fail_msg("whether %s is never negative is wrong", operation_name(operation));
  }
}

/* Doubling the unit halves the arguments. A value that keeps the unit is halved as well, a pure number is not. */
static void test_units(void **state) {
  (void)state;
  for (enum Operation operation = 0; operation < OPERATION_COUNT; operation++) {
    if (is_leaf(operation) || functions[operation].recurrence == ARITHMETIC) continue;
    const struct Reference *reference = reference_of(operation);
    bool is_kept = true, is_lost = true;
    for (int i = 0; i < POINTS; i++) {
      for (int j = 0; j < POINTS; j++) {
        long double here = value(reference, points[i], points[j]);
        long double halved = value(reference, points[i] / 2, points[j] / 2);
        if (isnan(here) && isnan(halved)) continue;
        is_kept = is_kept && fabsl(halved - here / 2) < 1e-15L;
        is_lost = is_lost && fabsl(halved - here) < 1e-15L;
      }
    }
    if (functions[operation].units != (is_kept ? UNIT_KEPT : is_lost ? UNIT_LOST : PURE_NUMBERS))
      fail_msg("the unit rule of %s is wrong", operation_name(operation));
  }
}

/* True if the operation has a real value at x; a power with the exponent 0.5. */
static bool is_real(enum Operation operation, double x) {
  return isfinite((double)value(reference_of(operation), x, 0.5));
}

static void test_domains(void **state) {
  (void)state;
  for (enum Operation operation = 0; operation < OPERATION_COUNT; operation++) {
    if (is_leaf(operation)) continue;
    const struct Domain *domain = &functions[operation].domain;
    const double ends[] = {domain->low, domain->high};
    for (int i = 0; i < 2; i++) {
      if (domain->kind == EVERYWHERE || isinf(ends[i])) continue;
      double outwards = i == 0 ? -INFINITY : INFINITY;
      const double near[] = {nextafter(ends[i], outwards), ends[i], nextafter(ends[i], -outwards)};
      assert_true(is_real(operation, near[2]) && !is_real(operation, near[0]));
      for (int k = 0; k < 3; k++)
        if (domain_contains(operation, near[k]) != is_real(operation, near[k]))
          fail_msg("whether the domain of %s holds %.17g is wrong", operation_name(operation), near[k]);
    }
    for (double x = -20.5; x < 20; x += 0.5)
      if (domain_contains(operation, x) != is_real(operation, x))
        fail_msg("whether the domain of %s holds %g is wrong", operation_name(operation), x);
  }
}

/* Piecewise functions have a kink or a jump where the auxiliary is 0; other functions have none. */
static void test_pieces(void **state) {
  (void)state;
  for (enum Operation operation = 0; operation < OPERATION_COUNT; operation++) {
    if (is_leaf(operation) || operation == POWER || operation == ATAN2) continue;
    /* handled by floor_of(), or not piecewise */
    if (operation == FLOOR || operation == UNIFORM || operation == GAUSS) continue;
    const struct Reference *reference = reference_of(operation);
    const long double h = 1e-6L;
    bool has_pieces = false;
    for (int j = 0; j < POINTS; j++) {
      long double y = points[j], x = reference->of_one != NULL ? 0 : y; /* a pole at 0 is neither */
      long double below = value(reference, x - h, y), at = value(reference, x, y), above = value(reference, x + h, y);
      has_pieces = has_pieces || fabsl(above - 2 * at + below) > h / 10 || fabsl(above - below) > 0.5L;
    }
    if (functions[operation].has_pieces != has_pieces)
      fail_msg("the pieces of %s are wrong", operation_name(operation));
  }
}

/* A composition of two functions is folded if it is piecewise linear, but not linear. */
static void test_folds(void **state) {
  (void)state;
  for (enum Operation outer = 0; outer < OPERATION_COUNT; outer++) {
    for (enum Operation inner = 0; inner < OPERATION_COUNT; inner++) {
      if (is_leaf(outer) || is_leaf(inner) || functions[outer].has_pieces || functions[inner].has_pieces) continue;
      OfOne *f = reference_of(outer)->of_one, *g = reference_of(inner)->of_one;
      if (f == NULL || g == NULL) continue;
      bool has_lines = true, has_turn = false;
      for (long double x = -7.04L; x < 7; x += 0.1L) {
        long double h = 1e-4L, here = (f(g(x + h)) - f(g(x - h))) / (2 * h), next = f(g(x + 3.3L)) - f(g(x));
        has_lines = has_lines && fabsl(fabsl(here) - 1) < 1e-6L;
        has_turn = has_turn || fabsl(next - here * 3.3L) > 1e-3L;
      }
      const struct Function *row = &functions[outer];
      bool is_folded = row->fold_name != NULL && (row->folded[0] == inner || row->folded[1] == inner);
      if (is_folded != (has_lines && has_turn))
        fail_msg("whether %s folds %s is wrong", row->name, operation_name(inner));
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_every_row_is_complete),
      cmocka_unit_test(test_names_in_c_and_limits),
      cmocka_unit_test(test_the_language_follows),
      cmocka_unit_test(test_values),
      cmocka_unit_test(test_derivatives),
      cmocka_unit_test(test_recurrences),
      cmocka_unit_test(test_auxiliaries_of_powers),
      cmocka_unit_test(test_parity_and_sign),
      cmocka_unit_test(test_units),
      cmocka_unit_test(test_domains),
      cmocka_unit_test(test_pieces),
      cmocka_unit_test(test_folds),
  };
  return cmocka_run_group_tests_name("functions", tests, NULL, NULL);
}
