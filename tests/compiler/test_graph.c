/* Hash-consing, order and dependencies of the expression graph. */
#include "base/memory.h"
#include "expressions.h"

static void test_equal_expressions_are_one_node(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  assert_int_equal(parse(&e, "sin(x)*y + z"), parse(&e, "z + y*sin(x)"));
  assert_int_not_equal(parse(&e, "atan2(x, y)"), parse(&e, "atan2(y, x)"));
}

static void test_operands_come_first(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  parse(&e, "sqrt(x^2 + y^2)*cos(z)/(1 + exp(x*y)) - atan2(x, z)");
  for (Node node = 0; node < e.graph->count; node++) {
    const struct Vertex *vertex = &e.graph->vertices[node];
    if (operation_arity(vertex->operation) > 0) assert_true(vertex->left < node);
    if (operation_arity(vertex->operation) > 1) assert_true(vertex->right < node);
  }
}

static void test_constants_are_compared_by_their_bits(void **state) {
  (void)state;
  struct Graph *graph = graph_create();
  assert_int_equal(graph_constant(graph, 0.0), ZERO);
  assert_int_equal(graph_constant(graph, 1.0), ONE);
  assert_int_equal(graph_constant(graph, NAN), graph_constant(graph, NAN));
  assert_int_equal(graph_constant(graph, 0.1 + 0.2), graph_constant(graph, 0.30000000000000004));
  assert_int_not_equal(graph_constant(graph, 0.1 + 0.2), graph_constant(graph, 0.3));
}

static void test_marking_finds_what_is_needed(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  Node target = parse(&e, "sin(x) + 2"), other = parse(&e, "cos(y)");
  bool *needed = allocate(e.graph->count, sizeof *needed);
  graph_mark(e.graph, &target, 1, needed);
  assert_true(needed[target] && needed[e.x]);
  assert_false(needed[other] || needed[e.y]);
  assert_true(graph_depends_on(e.graph, target, COORDINATE));
  assert_false(graph_depends_on(e.graph, target, VELOCITY));
}

static void test_growth(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  Node sum = ZERO;
  for (int i = 1; i <= 100000; i++) sum = add(e.graph, sum, function(e.graph, SINE, scale(e.graph, i, e.x), ZERO));
  double expected = 0.0;
  for (int i = 1; i <= 100000; i++) expected += sin(i * 0.01);
  assert_true(fabs(value_at(&e, sum, 0.01, 0, 0) - expected) < 1e-6);
}

/* Recursion must not be as deep as a product is long, which would overflow the stack. */
static void test_long_products(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  Node product = ONE;
  double expected = 1.0;
  for (int i = 1; i <= 300000; i++) {
    product = multiply(e.graph, product, function(e.graph, COSINE, scale(e.graph, 1e-8 * i, e.x), ZERO));
    expected *= cos(1e-8 * i * 0.5);
  }
  assert_true(fabs(value_at(&e, product, 0.5, 0, 0) - expected) < 1e-9);
  char *text = expression_text(e.graph, product);
  assert_true(strlen(text) < 100000);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_equal_expressions_are_one_node),
      cmocka_unit_test(test_operands_come_first),
      cmocka_unit_test(test_constants_are_compared_by_their_bits),
      cmocka_unit_test(test_marking_finds_what_is_needed),
      cmocka_unit_test(test_growth),
      cmocka_unit_test(test_long_products),
  };
  return cmocka_run_group_tests_name("graph", tests, NULL, NULL);
}
