/* Common factors of products: which ones are shared, which are not, and that values do not change. */
#include "expressions.h"
#include "algebra/cone.h"
#include "algebra/polynomials/shared_products.h"

enum { COUNT = 3 };

static size_t operations(const struct Expressions *e, const Node *nodes) {
  const struct Cone *cone = e->graph->cone;
  size_t operations = 0;
  cone_collect(e->graph->cone, e->graph, nodes, COUNT);
  for (size_t i = 0; i < cone->count; i++)
    operations += operation_arity(e->graph->vertices[cone->nodes[i]].operation) > 0;
  return operations;
}

/*
 * Each case: three expressions, of which the first `leading` ones decide which products are shared; operations before,
 * after.
 */
static void test_operations(void **state) {
  (void)state;
  static const struct {
    const char *texts[COUNT];
    size_t leading, before, after;
  } cases[] = {
      {{"2*x*y^2*z", "x*y*sin(z)", "0"}, COUNT, 7, 6},                /* u = x y: 2 (u y z), u sin z */
      {{"x^2*y^2*z", "x", "y"}, COUNT, 4, 3},                         /* (x y)^2 z */
      {{"x*y*z + 1", "(x*y*cos(z) + 2)*x*y", "0"}, COUNT, 8, 7},      /* inside a factor, too */
      {{"sin(x)*z*y", "cos(z)*sin(x)*y", "sin(x)*y/x"}, COUNT, 9, 7}, /* of numerators */
      {{"x^3*y", "x^3*z", "x*y*z"}, COUNT, 5, 5},                     /* powers stay whole */
      {{"x*y + 1", "y*z + 2", "x*z + 3"}, COUNT, 6, 6},               /* no pair occurs twice */
      {{"sqrt(x*y*z)", "x*y + 1", "exp(x*z*y)"}, COUNT, 7, 7},        /* operands of functions stay */
      {{"x*z*y", "cos(z)*x*y", "exp(z)*(y*x)"}, 2, 8, 6},             /* the third reuses x y of the others */
      {{"x*y*z", "sin(z)*y", "cos(z)*y*z"}, 2, 7, 7},                 /* the third does not decide: y z is not shared */
  };
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    struct Expressions e = expressions_create();
    Node nodes[COUNT], shared[COUNT];
    for (int i = 0; i < COUNT; i++) nodes[i] = shared[i] = parse(&e, cases[k].texts[i]);
    share_products(e.graph, cases[k].leading, COUNT, shared);
    assert_int_equal(operations(&e, nodes), cases[k].before);
    assert_int_equal(operations(&e, shared), cases[k].after);
    for (int i = 0; i < COUNT; i++) {
      double before = value_at(&e, nodes[i], 0.7, 1.3, 0.4), after = value_at(&e, shared[i], 0.7, 1.3, 0.4);
      assert_true(fabs(after - before) <= 1e-15 * fabs(before));
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_operations)};
  return cmocka_run_group_tests_name("shared_products", tests, NULL, NULL);
}
