/* The simplifications of the graph, and that they never change a value. */
#include "expressions.h"
#include "algebra/polynomials/rational.h"

static void test_simplifications(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  assert_prints(&e, "x + 0", "x");
  assert_prints(&e, "x*1", "x");
  assert_prints(&e, "x*0", "0");
  assert_prints(&e, "x - x", "0");
  assert_prints(&e, "2*x + 3*x", "5*x");
  assert_prints(&e, "x/x", "1");
  assert_prints(&e, "x*y/x", "y");
  assert_prints(&e, "x*x*x", "x^3");
  assert_prints(&e, "--x", "x");
  assert_prints(&e, "2^3^2", "512");
  assert_prints(&e, "-2^2", "-4");
  assert_prints(&e, "sin(0) + cos(0)", "1");
  assert_prints(&e, "sin(x)^2 + cos(x)^2", "1");
  assert_prints(&e, "y*sin(x)^2 + y*cos(x)^2", "y");
  assert_prints(&e, "sin(-x)", "-sin(x)");
  assert_prints(&e, "cos(-x)", "cos(x)");
  assert_prints(&e, "x^0.5*x^0.5", "x");
  assert_int_equal(e.diagnostics.errors, 0);
}

/* A root of an even power has a kink, written as abs; values are tested for both signs of the base. */
static void test_roots_of_even_powers(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  assert_prints(&e, "sqrt(x^2)", "abs(x)");
  assert_prints(&e, "(x^4)^0.5", "x^2");
  assert_prints(&e, "sqrt(exp(x)^2)", "exp(x)");
  assert_prints(&e, "1^x", "1");
  static const struct {
    const char *text;
    double value; /* at x = -3, y = 5 */
  } cases[] = {{"sqrt(x^2)", 3.0},      {"(x^2)^1.5", 27.0},
               {"x*sqrt(x^2)", -9.0},   {"sqrt(4*x^2*y)", 6.0 * 2.23606797749979},
               {"(x^6)^(1/3)", 9.0},    {"(x^-2)^0.5", 1.0 / 3.0},
               {"sqrt(x^2*y^4)", 75.0}, {"sqrt(x^2 - 2*x + 1)", 4.0}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    assert_true(fabs(value_at(&e, parse(&e, cases[i].text), -3, 5, 0) - cases[i].value) < 1e-13);
}

/* More factors than the algebra examines, and longer products; some factors cancel. */
static void test_long_products_keep_values(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  Node different = ONE, alternating = ONE;
  double of_different = 1.0, of_alternating = 1.0;
  for (int i = 1; i <= 14; i++) {
    different = multiply(e.graph, different, function(e.graph, COSINE, scale(e.graph, i, e.x), ZERO));
    of_different *= cos(0.1 * i);
    different = divide(e.graph, different, function(e.graph, COSINE, e.x, ZERO));
    of_different /= cos(0.1);
    assert_true(fabs(value_at(&e, different, 0.1, 0, 0) - of_different) < 1e-12 * fabs(of_different));
  }
  for (int i = 0; i < 75; i++) {
    alternating = multiply(e.graph, alternating, i % 2 == 0 ? e.x : e.y);
    of_alternating *= i % 2 == 0 ? 1.1 : 0.9;
    Node quotient = divide(e.graph, alternating, e.x);
    assert_true(fabs(value_at(&e, quotient, 1.1, 0.9, 0) - of_alternating / 1.1) < 1e-12);
  }
}

/* Functions of equal operands, of abs and of negative arguments, at x = -3, y = 0.5. */
static void test_functions_of_special_operands(void **state) {
  (void)state;
  static const struct {
    const char *text;
    double value;
  } cases[] = {{"atan2(x, x)", -2.356194490192345},
               {"min(x, x) + max(y, y)", -2.5},
               {"abs(x)^3", 27.0},
               {"abs(x)^2", 9.0},
               {"acos(-y)", 2.0943951023931957},
               {"asin(-y)", -0.5235987755982989},
               {"abs(-x^3)", 27.0},
               {"sqrt(x^2)^3", 27.0},
               {"abs(x)*x", -9.0},
               {"cosh(-x) - cosh(x)", 0.0},
               {"log(-x)", 1.0986122886681098}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct Expressions e = expressions_create();
    double value = value_at(&e, parse(&e, cases[i].text), -3, 0.5, 0);
    if (!(fabs(value - cases[i].value) < 1e-14)) fail_msg("%s is %.17g", cases[i].text, value);
  }
}

static void test_signs_and_precedence(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  Node node = parse(&e, "-x^2 - -y*2 + z/2/4 - (x - y - z)^2^1");
  assert_true(fabs(value_at(&e, node, 3, 5, 7) - (-9.0 + 10 + 7.0 / 8 - 81)) < 1e-12);
}

/* Writes a random expression as text, to test parser, algebra and evaluation together. */
static void random_text(unsigned *seed, int depth, char *text, size_t size) {
  static const char *const forms[] = {"(%s + %s)", "(%s - %s)", "%s*%s", "(%s)/(3 + (%s)^2)", "sin(%s)*cos(%s)"};
  static const char *const leaves[] = {"x", "y", "z", "2", "0.5", "sin(x)", "cos(x)", "sin(y)^2", "cos(y)^2"};
  *seed = *seed * 1103515245u + 12345u;
  unsigned choice = *seed >> 16;
  if (depth == 0) {
    snprintf(text, size, "%s", leaves[choice % (sizeof leaves / sizeof *leaves)]);
    return;
  }
  char left[4000], right[4000];
  random_text(seed, depth - 1, left, sizeof left);
  random_text(seed, depth - 1, right, sizeof right);
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
  snprintf(text, size, forms[choice % (sizeof forms / sizeof *forms)], left, right);
#pragma GCC diagnostic pop
}

/* Evaluates the text without algebra: every number, name and operator by itself. */
static double plain_sum(const char **text, const double *values);

static double plain_primary(const char **text, const double *values) {
  double value;
  if (**text == '(') {
    ++*text;
    value = plain_sum(text, values);
    ++*text;
  } else if (strncmp(*text, "sin(", 4) == 0 || strncmp(*text, "cos(", 4) == 0) {
    bool sine = **text == 's';
    *text += 4;
    value = plain_sum(text, values);
    value = sine ? sin(value) : cos(value);
    ++*text;
  } else if (**text >= 'x' && **text <= 'z') value = values[*(*text)++ - 'x'];
  else {
    char *end;
    value = strtod(*text, &end);
    *text = end;
  }
  if (**text != '^') return value;
  ++*text;
  return pow(value, plain_primary(text, values));
}

static double plain_term(const char **text, const double *values) {
  double value = plain_primary(text, values);
  while (**text == '*' || **text == '/') {
    char operator= *(*text)++;
    double factor = plain_primary(text, values);
    value = operator== '*' ? value * factor : value / factor;
  }
  return value;
}

static double plain_sum(const char **text, const double *values) {
  double value = plain_term(text, values);
  while ((*text)[0] == ' ') {
    char operator=(*text)[1];
    *text += 3;
    double term = plain_term(text, values);
    value = operator== '+' ? value + term : value - term;
  }
  return value;
}

static void test_algebra_keeps_values(void **state) {
  (void)state;
  unsigned seed = 7;
  const double at[] = {0.7, -1.3, 2.1};
  for (int i = 0; i < 2000; i++) {
    struct Expressions e = expressions_create();
    char text[10000];
    random_text(&seed, 1 + i % 5, text, sizeof text);
    Node node = parse(&e, text), fraction = simplify_fraction(e.graph, node);
    const char *rest = text;
    double plain = plain_sum(&rest, at);
    assert_int_equal(*rest, '\0');
    assert_true(fabs(value_at(&e, node, at[0], at[1], at[2]) - plain) <= 1e-9 * (1 + fabs(plain)));
    assert_true(fabs(value_at(&e, fraction, at[0], at[1], at[2]) - plain) <= 1e-7 * (1 + fabs(plain)));
  }
}

static void test_printed_text_reads_back(void **state) {
  (void)state;
  unsigned seed = 11;
  for (int i = 0; i < 500; i++) {
    struct Expressions e = expressions_create();
    char text[10000];
    random_text(&seed, 1 + i % 4, text, sizeof text);
    Node node = parse(&e, text);
    char *printed = expression_text(e.graph, node);
    Node again = parse(&e, printed);
    double first = value_at(&e, node, 0.7, -1.3, 2.1), second = value_at(&e, again, 0.7, -1.3, 2.1);
    assert_true(fabs(first - second) <= 1e-12 * (1 + fabs(first)));
  }
}

static void test_fractions_cancel(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  char *text = expression_text(e.graph, simplify_fraction(e.graph, parse(&e, "(x^2 - y^2)/(x - y)")));
  assert_string_equal(text, "x + y");
}

static void test_sums_that_stay_whole(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  struct Graph *graph = e.graph;
  Node x = parse(&e, "x"), y = parse(&e, "y"), whole = parse(&e, "x + y"), two = graph_constant(graph, 2.0);
  assert_int_equal(add(graph, whole, x), parse(&e, "2*x + y"));
  Node sum = add_whole(graph, whole, x);
  assert_true(graph->vertices[sum].operation == ADD &&
              graph->vertices[sum].left + graph->vertices[sum].right == whole + x);
  assert_int_equal(add_whole(graph, whole, whole), multiply(graph, two, whole));
  assert_int_equal(add_whole(graph, whole, negate(graph, whole)), ZERO);
  assert_int_equal(add_whole(graph, ZERO, y), y);
  assert_int_equal(add_whole(graph, ONE, ONE), two);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_simplifications),           cmocka_unit_test(test_signs_and_precedence),
      cmocka_unit_test(test_algebra_keeps_values),      cmocka_unit_test(test_printed_text_reads_back),
      cmocka_unit_test(test_fractions_cancel),          cmocka_unit_test(test_roots_of_even_powers),
      cmocka_unit_test(test_long_products_keep_values), cmocka_unit_test(test_functions_of_special_operands),
      cmocka_unit_test(test_sums_that_stay_whole),
  };
  return cmocka_run_group_tests_name("simplify", tests, NULL, NULL);
}
