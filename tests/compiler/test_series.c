/*
 * The recurrences of include/series.h and the limits of include/series_limit.h, against series and radii in closed
 * form.
 */
#include "expressions.h"
#include "series.h"
#include "series_limit.h"

enum { ORDER = SERIES_LENGTH - 1 };

/* Coefficients of first e^(rate t). */
static void exponential(Series a, double first, double rate) {
  a[0] = first;
  for (int k = 1; k <= ORDER; k++) a[k] = a[k - 1] * rate / k;
}

/* Recurrences lose up to four digits by cancellation. */
static void assert_near(double value, double expected) {
  if (!(fabs(value - expected) <= 1e-9 * fabs(expected))) fail_msg("%.17g, expected %.17g", value, expected);
}

/* Runs a check at each order, once with the order as a constant, which compilers unroll, and once as a variable. */
#define EACH_ORDER(CHECK)                                                                                              \
  CHECK(1)                                                                                                             \
  CHECK(2)                                                                                                             \
  CHECK(3)                                                                                                             \
  CHECK(4)                                                                                                             \
  CHECK(5)                                                                                                             \
  CHECK(6)                                                                                                             \
  CHECK(7)                                                                                                             \
  CHECK(8)                                                                                                             \
  CHECK(9)                                                                                                             \
  CHECK(10)                                                                                                            \
  CHECK(11)                                                                                                            \
  CHECK(12)                                                                                                            \
  CHECK(13)                                                                                                            \
  CHECK(14)                                                                                                            \
  CHECK(15)                                                                                                            \
  CHECK(16)                                                                                                            \
  CHECK(17)                                                                                                            \
  CHECK(18)                                                                                                            \
  CHECK(19)                                                                                                            \
  CHECK(20)                                                                                                            \
  CHECK(21)                                                                                                            \
  CHECK(22)                                                                                                            \
  CHECK(23)

static void test_products(void **state) {
  (void)state;
  Series a, b, product, square;
  exponential(a, 1, 1);
  exponential(b, 3, 2);
  exponential(product, 3, 3);
  exponential(square, 1, 2);
#define CHECK(order)                                                                                                   \
  assert_near(series_product(order, a, b), product[order]);                                                            \
  assert_near(series_square(order, a), square[order]);                                                                 \
  assert_near(series_rest(order, a, b), product[order] - a[0] * b[order]);                                             \
  assert_near(series_integral(order, a, b), (order) > 0 ? product[(order)-1] / (order) : 0);
  EACH_ORDER(CHECK)
#undef CHECK
  for (volatile int k = 1; k <= ORDER; k++) {
    assert_near(series_product(k, a, b), product[k]);
    assert_near(series_square(k, a), square[k]);
    assert_near(series_rest(k, a, b), product[k] - a[0] * b[k]);
    assert_near(series_integral(k, a, b), product[k - 1] / k);
  }
}

/* As in series() of a generated system: all products of an order first, in one loop or from a list. */
static void test_products_that_are_begun_together(void **state) {
  (void)state;
  Series a, b, product, square, quotient, root;
  exponential(a, 2, 3);
  exponential(b, 3, 1);
  exponential(product, 6, 4);
  exponential(square, 4, 6);
  exponential(quotient, 2.0 / 3, 2);
  exponential(root, sqrt(2), 1.5);
#define PRODUCTS(EACH) EACH(0, a, 1, b) EACH(1, a, 1, a) EACH(2, b, 1, quotient) EACH(3, root, 1, root) EACH(4, a, 0, b)
  const struct SeriesFactors factors[] = {{a + 1, b}, {a + 1, a}, {b + 1, quotient}, {root + 1, root}, {a, b}};
  for (int i = 0; i < 2 * ORDER; i++) {
    int k = 1 + i / 2;
    Real m[5];
    if (i % 2 == 0) SERIES_MIDDLES(PRODUCTS);
    else series_middles(k, 5, factors, m);
    assert_near(series_product_around(m[0], k, a, b), product[k]);
    assert_near(series_rest_around(m[0], k, a, b), product[k] - a[0] * b[k]);
    assert_near(series_square_around(m[1], k, a), square[k]);
    assert_near(series_quotient_around(m[2], k, a[k], 1 / b[0], b, quotient), quotient[k]);
    /* it subtracts the middle terms from a_k */
    assert_near(series_root_around(m[3], k, a, root) + a[k], root[k] + a[k]);
    assert_near(series_integral_around(m[4], k, a, b), product[k - 1] / k);
  }
#undef PRODUCTS
}

static void test_quotients_roots_and_powers(void **state) {
  (void)state;
  Series a, b, quotient, root, power, moved = {0}, cube = {0}, zero = {0};
  exponential(a, 2, 3);
  exponential(b, 4, 1);
  exponential(quotient, 0.5, 2);
  exponential(root, sqrt(2), 1.5);
  exponential(power, pow(2, -1.5), -4.5);
  /* (2 t e^(3 t))^3 = 8 t^3 e^(9 t) */
  for (int k = 1; k <= ORDER; k++) moved[k] = a[k - 1];
  exponential(cube, 8, 9);
  for (int k = ORDER; k >= 0; k--) cube[k] = k >= 3 ? cube[k - 3] : 0.0;
  for (int k = 1; k <= ORDER; k++) {
    assert_near(series_quotient(k, a[k], 1 / b[0], b, quotient), quotient[k]);
    assert_near(series_root(k, a, root) + a[k], root[k] + a[k]); /* it subtracts the middle terms from a_k */
    assert_near(series_power(k, -1.5, a, power), power[k]);
    assert_near(series_power(k, 3, moved, cube), cube[k]);
    assert_true(isnan(series_power(k, 0.5, moved, zero)) && isnan(series_power(k, -1, moved, zero)));
    assert_true(series_root(k, zero, zero) == 0.0 && series_power(k, 2, zero, zero) == 0.0);
  }
}

static void test_integrals_of_quotients(void **state) {
  (void)state;
  Series a, b, c, y, x, y_over_x = {0.0, 1.0};
  exponential(a, 1, 3);
  exponential(b, 1, 1);
  exponential(c, 1.5, 2); /* c' = a'/b */
  for (int k = 1; k <= ORDER; k++) assert_near(series_ratio_integral(k, a[k], b, c), c[k]);
  /* y = e^t sin(t), x = e^t cos(t): powers of sqrt(2) e^(i pi/4); the angle is t, and x^2 + y^2 = e^(2 t) */
  double factorial = 1.0;
  for (int k = 0; k <= ORDER; k++, factorial *= k) {
    y[k] = pow(2, k / 2.0) * sin(k * 3.141592653589793 / 4) / factorial;
    x[k] = pow(2, k / 2.0) * cos(k * 3.141592653589793 / 4) / factorial;
  }
  exponential(b, 1, 2);
  for (int k = 1; k <= ORDER; k++) {
    assert_true(fabs(series_area(k, y, x) - b[k - 1] / k) < 1e-14 * b[k - 1]); /* y' x - x' y = e^(2 t) */
    assert_true(fabs(series_angle(k, y, x, b, y_over_x) - (k == 1)) < 1e-14);
  }
}

static void test_signs(void **state) {
  (void)state;
  const Series falls = {0, 0, -3, 5}, rises = {0, 2, -9}, zero = {0};
  assert_true(series_sign(3, falls) == -1.0 && series_sign(1, falls) == 0.0 && series_sign(2, rises) == 1.0);
  assert_true(series_absolute(2, falls) == 3.0 && series_absolute(3, falls) == -5.0);
  assert_true(series_absolute(2, rises) == -9.0 && series_absolute(2, zero) == 0.0);
}

/* Limits are found to a factor of 8^(1/16), and never exceeded. */
static void assert_limited(const struct SeriesLimit *limit, double expected, const char *function) {
  if (!(limit->step <= expected * (1 + 1e-14) && limit->step >= 0.878 * expected))
    fail_msg("%.17g, expected %.17g", limit->step, expected);
  if (function == NULL) assert_null(limit->function);
  else assert_string_equal(limit->function, function);
}

enum { LIMIT_ORDER = 12 };
static const struct SeriesLimit far_away = {.order = LIMIT_ORDER, .step = 1e6};

/* u = first + slope t */
#define LINE(first, slope)                                                                                             \
  (const Series) {                                                                                                     \
    first, slope                                                                                                       \
  }

static void test_limits_of_functions(void **state) {
  (void)state;
  struct SeriesLimit limit = far_away;
  series_limit_exponential(&limit, LINE(3, -2), "exp"); /* a factor of e^5 */
  assert_limited(&limit, 2.5, "exp");
  limit = far_away;
  series_limit_exponential(&limit, LINE(-900, 2), "exp"); /* 0 up to u = -700 */
  assert_limited(&limit, 100, "exp");
  limit = far_away;
  series_limit_hyperbolic(&limit, LINE(3, 0.5), "cosh");
  assert_limited(&limit, 10, "cosh");
  limit = far_away;
  series_limit_bounded(&limit, LINE(-0.3, 2), "1/cosh");
  assert_limited(&limit, 2.5, "1/cosh");
  limit = far_away;
  series_limit_bounded(&limit, LINE(900, -2), "1/cosh"); /* below 1e-304 as far as |u| = 700 */
  assert_limited(&limit, 100, "1/cosh");
  limit = far_away;
  series_limit_tanh(&limit, LINE(0.3, 2));
  assert_limited(&limit, 2.5, "tanh");
  limit = far_away;
  series_limit_tanh(&limit, LINE(-120, 2)); /* 1 down to |u| = 20 */
  assert_limited(&limit, 50, "tanh");
  limit = far_away;
  series_limit_tangent(&limit, LINE(4, 0.5)); /* the poles are at pi/2 and 3 pi/2 */
  assert_limited(&limit, 0.99 * (4.71238898038469 - 4) / 0.5, "tan");
  limit = far_away;
  series_limit_positive(&limit, LINE(3, 0.5), "log");
  assert_limited(&limit, 0.99 * 6, "log");
  limit = (struct SeriesLimit){.order = LIMIT_ORDER, .step = 1.0};
  series_limit_exponential(&limit, LINE(3, -2), "exp");
  assert_limited(&limit, 1.0, NULL);
}

static void test_limits_of_powers(void **state) {
  (void)state;
  struct SeriesLimit limit = far_away;
  series_limit_quotient(&limit, LINE(3, 0.5), series_limit_share(-20)); /* e^(5/20) of the power */
  assert_limited(&limit, 6 * (1 - exp(-0.25)), "a division or power");
  limit = far_away;
  series_limit_quotient(&limit, LINE(3, 0.5), series_limit_share(-1));
  assert_limited(&limit, 6 * 0.99, "a division or power");
  limit = far_away;
  series_limit_root(&limit, LINE(-3, 0.5), series_limit_share(0.5));
  assert_limited(&limit, 6 * 0.99, "a root");
  limit = far_away;
  /* turning point at 2/sqrt(3) */
  series_limit_whole_power(&limit, (const Series){2, -1, 0, 0.25}, series_limit_share(10));
  assert_limited(&limit, 2 / sqrt(3), "a power");
  limit = far_away;
  series_limit_whole_power(&limit, LINE(2, -1), series_limit_share(10)); /* no turning point */
  assert_limited(&limit, 1e6, NULL);
  limit = far_away;
  series_limit_division(&limit, LINE(3, 0.5), (const Series){0}, series_limit_share(-1)); /* vanishes at all times */
  assert_limited(&limit, 1e6, NULL);
  series_limit_division(&limit, LINE(3, 0.5), (const Series){0, 0, 1}, series_limit_share(-1));
  assert_limited(&limit, 6 * 0.99, "a division or power");
  limit = far_away;
  series_limit_power(&limit, LINE(3, 0.5), -20);
  assert_limited(&limit, 6 * (1 - exp(-0.25)), "a division or power");
  limit = far_away;
  series_limit_power(&limit, LINE(3, 0.5), 2.5);
  assert_limited(&limit, 6 * 0.99, "a root");
  limit = far_away;
  series_limit_power(&limit, LINE(3, 0.5), 3);
  assert_limited(&limit, 1e6, NULL);
}

static void test_limits_of_pieces(void **state) {
  (void)state;
  struct SeriesLimit limit = far_away;
  series_limit_sign(&limit, LINE(3, -0.5), "abs");
  assert_limited(&limit, 6 * 0.99, "abs");
  limit = far_away;
  series_limit_sign(&limit, LINE(3, 0.5), "abs"); /* away from 0 */
  assert_limited(&limit, 1e6, NULL);
  series_limit_sign(&limit, LINE(0, -0.5), "abs"); /* leaves 0 to one side */
  assert_limited(&limit, 1e6, NULL);
  series_limit_angle(&limit, LINE(1, 1), LINE(3, 0)); /* right of the y axis */
  assert_limited(&limit, 1e6, NULL);
  series_limit_angle(&limit, LINE(2, -0.5), LINE(-3, 1));
  assert_limited(&limit, 4 * 0.99, "atan2");
  const struct SeriesLimit crossing = {.order = LIMIT_ORDER, .step = 1e6, .crosses = true};
  limit = crossing;
  series_limit_sign(&limit, LINE(3, -0.5), "abs");
  series_limit_root(&limit, LINE(3, -0.5), 1);
  series_limit_whole_power(&limit, (const Series){2, -1, 0, 0.25}, 1);
  series_limit_angle(&limit, LINE(2, -0.5), LINE(-3, 1));
  assert_limited(&limit, 1e6, NULL);
  series_limit_quotient(&limit, LINE(3, -0.5), series_limit_share(-1));
  assert_limited(&limit, 6 * 0.99, "a division or power");
}

/* The sum of |u_k| step^k for all orders, multiples of four or not. */
static void test_excursions(void **state) {
  (void)state;
  for (int order = 1; order <= ORDER; order++) {
    Series u;
    for (int k = 0; k <= ORDER; k++) u[k] = k % 3 == 0 ? -1.0 : 1.0;
    struct SeriesLimit limit = {.order = order, .step = 1e3};
    series_limit_hyperbolic(&limit, u, "sinh");
    double low = 0.0, high = 5.0; /* bisection for a geometric sum of 5 */
    for (int i = 0; i < 60; i++) {
      double middle = (low + high) / 2, sum = 0.0;
      for (int k = 1; k <= order; k++) sum += pow(middle, k);
      if (sum <= 5.0) low = middle;
      else high = middle;
    }
    assert_limited(&limit, high, "sinh");
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_products),
      cmocka_unit_test(test_products_that_are_begun_together),
      cmocka_unit_test(test_quotients_roots_and_powers),
      cmocka_unit_test(test_integrals_of_quotients),
      cmocka_unit_test(test_signs),
      cmocka_unit_test(test_limits_of_functions),
      cmocka_unit_test(test_limits_of_powers),
      cmocka_unit_test(test_limits_of_pieces),
      cmocka_unit_test(test_excursions),
  };
  return cmocka_run_group_tests_name("series", tests, NULL, NULL);
}
