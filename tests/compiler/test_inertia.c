/* The symbolic mass matrix: coupled coordinates and factors. */
#include "base/memory.h"
#include "expressions.h"
#include "mechanics/mass_matrix/mass_elements.h"
#include "mechanics/mass_matrix/pivots.h"
#include "mechanics/mass_matrix/rotated.h"

enum { COORDINATES = 12, ELEMENTS = COORDINATES * (COORDINATES + 1) / 2 };

/* Computes the transitive closure by Warshall's algorithm: true for pairs coupled directly or indirectly. */
static void close_pattern(bool coupled[COORDINATES][COORDINATES]) {
  for (size_t k = 0; k < COORDINATES; k++)
    for (size_t i = 0; i < COORDINATES; i++)
      for (size_t j = 0; j < COORDINATES; j++) coupled[i][j] |= coupled[i][k] && coupled[k][j];
}

/*
 * Checks the components of a matrix with elements at positions (i, j), j <= i, and the whole diagonal. The node of an
 * element encodes its position.
 */
static void check_components(struct Position *positions, size_t count) {
  struct Elements elements = {.count = count};
  bool coupled[COORDINATES][COORDINATES] = {{false}};
  elements.positions = allocate(count, sizeof *elements.positions);
  elements.nodes = allocate(count, sizeof *elements.nodes);
  for (size_t k = 0; k < count; k++) {
    elements.positions[k] = positions[k];
    elements.nodes[k] = (Node)(positions[k].row * COORDINATES + positions[k].column);
    coupled[positions[k].row][positions[k].column] = coupled[positions[k].column][positions[k].row] = true;
  }
  close_pattern(coupled);
  struct ConnectedComponents components = find_components(COORDINATES, &elements);
  size_t found = 0;
  for (size_t i = 0; i < COORDINATES; i++) {
    for (size_t j = 0; j < COORDINATES; j++) assert_int_equal(components.of[i] == components.of[j], coupled[i][j]);
    bool is_first = true;
    for (size_t j = 0; j < i; j++) is_first &= !coupled[i][j];
    if (is_first) assert_int_equal(components.of[i], found++);
  }
  assert_int_equal(components.count, found);
  size_t *start = sort_by_components(&elements, &components);
  assert_true(start[0] == 0 && start[components.count] == count);
  for (size_t b = 0; b < components.count; b++)
    for (size_t k = start[b]; k < start[b + 1]; k++) {
      assert_int_equal(components.of[elements.positions[k].row], b);
      assert_int_equal(elements.nodes[k], elements.positions[k].row * COORDINATES + elements.positions[k].column);
    }
}

static void shuffle(struct Position *positions, size_t count, unsigned *seed) {
  for (size_t i = count; i > 1; i--) {
    *seed = *seed * 1103515245u + 12345u;
    size_t j = (*seed >> 16) % i;
    struct Position other = positions[i - 1];
    positions[i - 1] = positions[j];
    positions[j] = other;
  }
}

static void test_components(void **state) {
  (void)state;
  unsigned seed = 5;
  for (int trial = 0; trial < 2000; trial++) {
    struct Position positions[ELEMENTS];
    size_t count = 0;
    for (size_t i = 0; i < COORDINATES; i++)
      for (size_t j = 0; j <= i; j++) {
        seed = seed * 1103515245u + 12345u;
        if (i == j || (seed >> 16) % 100 < 10) positions[count++] = (struct Position){i, j};
      }
    shuffle(positions, count, &seed);
    check_components(positions, count);
  }
}

/* A tridiagonal matrix is one component in any order of its elements; without one element, two. */
static void test_components_of_a_chain(void **state) {
  (void)state;
  struct Position chain[2 * COORDINATES];
  unsigned seed = 3;
  for (int trial = 0; trial < 100; trial++) {
    size_t count = 0;
    for (size_t i = 0; i < COORDINATES; i++) {
      chain[count++] = (struct Position){i, i};
      if (i > 0 && (trial % 2 == 0 || i != 5)) chain[count++] = (struct Position){i, i - 1};
    }
    shuffle(chain, count, &seed);
    check_components(chain, count);
  }
}

enum { SIZE = 3, FULL = SIZE * (SIZE + 1) / 2 };

/* Factors a block of three coordinates; mass: its lower triangle by rows. */
static struct Inertia factor(struct Expressions *e, struct InertiaBlock *block, const char *const mass[FULL]) {
  static size_t start[] = {0, 1, 3, 6}, column[] = {0, 0, 1, 0, 1, 2}, coordinates[] = {2, 0, 1};
  static Node nodes[FULL];
  for (int k = 0; k < FULL; k++) nodes[k] = parse(e, mass[k]);
  *block = (struct InertiaBlock){
      .count = SIZE, .coordinates = coordinates, .is_unrolled = true, .start = start, .column = column, .mass = nodes};
  struct Inertia inertia = {.count = SIZE, .coordinate_count = SIZE, .blocks = block, .block_count = 1};
  pivots_factor(e->graph, &inertia);
  return inertia;
}

/* L D L^T equals M, and the solution of M x = b satisfies it, for numeric values. */
static void test_symbolic_factors(void **state) {
  (void)state;
  struct Expressions e = expressions_create();
  struct InertiaBlock block;
  struct Inertia inertia = factor(&e, &block, (const char *const[]){"x + 2", "y*z", "5 + y^2", "x", "sin(z)", "7"});
  const double x = 0.7, y = -1.3, z = 2.1;
  const double m[SIZE][SIZE] = {{x + 2, y * z, x}, {y * z, 5 + y * y, sin(z)}, {x, sin(z), 7}};
  double lower[SIZE][SIZE] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, diagonal[SIZE];
  for (int i = 0, k = 0; i < SIZE; i++) {
    for (int j = 0; j < i; j++) lower[i][j] = value_at(&e, block.factor[k++], x, y, z);
    diagonal[i] = value_at(&e, block.factor[k++], x, y, z);
  }
  Node solution[] = {parse(&e, "1"), parse(&e, "x"), parse(&e, "y*z")};
  const double right[] = {1, x, y * z};
  block_solve(e.graph, &block, solution);
  for (int i = 0; i < SIZE; i++) {
    double product = 0;
    for (int j = 0; j < SIZE; j++) {
      double sum = 0;
      for (int k = 0; k < SIZE; k++) sum += lower[i][k] * diagonal[k] * lower[j][k];
      assert_true(fabs(sum - m[i][j]) < 1e-14);
      product += m[i][j] * value_at(&e, solution[j], x, y, z);
    }
    assert_true(fabs(product - right[i]) < 1e-14);
    const struct Pivot *pivot = &inertia.pivots[i];
    assert_int_equal(pivot->coordinate, block.coordinates[i]);
    assert_int_equal(pivot->value, block.factor[block.start[i + 1] - 1]);
    assert_int_equal(pivot->diagonal, block.mass[block.start[i + 1] - 1]);
  }
  assert_int_equal(inertia.pivot_count, SIZE);
}

/* The magnitude of the terms of a diagonal element with |sin| and |cos| taken as 1, at x = 3, y = 0.5, z = 2. */
static void test_scales_of_pivots(void **state) {
  (void)state;
  static const struct {
    const char *mass;
    double scale;
  } cases[] = {
      {"x^2*sin(y)^2", 9},
      {"x^2 + y^2 - 2*x*y*cos(z)", 9 + 0.25 + 3},
      {"x^2*(2 - 2*cos(y))", 36},
      {"x*(sin(y) - y*cos(z))^2", 3 * 1.5 * 1.5},
      {"5*sin(y)^4*cos(z)^2", 5},
      {"(4 + cos(y))^-1", 1 / (4 + 0.8775825618903728)}, /* a quotient counts as itself */
      {"exp(x)*cos(z)^2", 20.085536923187668},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct Expressions e = expressions_create();
    struct InertiaBlock block;
    struct Inertia inertia = factor(&e, &block, (const char *const[]){cases[i].mass, "0", "1", "0", "0", "1"});
    double scale = value_at(&e, inertia.pivots[0].scale, 3, 0.5, 2);
    if (!(fabs(scale - cases[i].scale) < 1e-12)) fail_msg("the scale of %s is %.17g", cases[i].mass, scale);
  }
}

/* Returns the rotation by x about an axis; as numbers: the same, for a value of x. */
static struct Matrix rotation_about(struct Expressions *e, int axis, double x, double numbers[3][3]) {
  int j = (axis + 1) % 3, k = (axis + 2) % 3;
  struct Matrix rotation = {{{{ZERO, ZERO, ZERO}}, {{ZERO, ZERO, ZERO}}, {{ZERO, ZERO, ZERO}}}};
  memset(numbers, 0, 9 * sizeof(double));
  rotation.row[axis].along[axis] = ONE;
  rotation.row[j].along[j] = rotation.row[k].along[k] = parse(e, "cos(x)");
  rotation.row[k].along[j] = parse(e, "sin(x)");
  rotation.row[j].along[k] = parse(e, "-sin(x)");
  numbers[axis][axis] = 1;
  numbers[j][j] = numbers[k][k] = cos(x);
  numbers[k][j] = sin(x);
  numbers[j][k] = -sin(x);
  return rotation;
}

/* Counts the products from a node on, without those with numbers, such as -1. */
static size_t count_products(const struct Graph *graph, size_t first) {
  size_t count = 0;
  for (size_t i = first; i < graph->count; i++) {
    const struct Vertex *vertex = &graph->vertices[i];
    count += vertex->operation == MULTIPLY && graph->vertices[vertex->left].operation != CONSTANT &&
             graph->vertices[vertex->right].operation != CONSTANT;
  }
  return count;
}

/* R M R^T for a rotation about each axis: four products for the block across, and four for each of two pairs. */
static void test_rotations_about_axes(void **state) {
  (void)state;
  static const char *const texts[3][3] = {
      {"y", "2*z", "1 + y"}, {"3 + z", "y^2", "z^2"}, {"y - z", "sin(y)", "sin(z)"}};
  const double x = 0.7, y = -1.3, z = 2.1;
  const double m[3][3] = {{y, 2 * z, 1 + y}, {3 + z, y * y, z * z}, {y - z, sin(y), sin(z)}};
  for (int axis = 0; axis < 3; axis++) {
    struct Expressions e = expressions_create();
    double r[3][3];
    struct Matrix rotation = rotation_about(&e, axis, x, r), matrix;
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) matrix.row[i].along[j] = parse(&e, texts[i][j]);
    size_t before = e.graph->count;
    struct Matrix result = matrix_rotated(e.graph, &rotation, &matrix);
    assert_in_range(count_products(e.graph, before), 1, 12);
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) {
        double expected = 0;
        for (int k = 0; k < 3; k++)
          for (int l = 0; l < 3; l++) expected += r[i][k] * m[k][l] * r[j][l];
        assert_true(fabs(value_at(&e, result.row[i].along[j], x, y, z) - expected) < 1e-14);
      }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_components),           cmocka_unit_test(test_components_of_a_chain),
      cmocka_unit_test(test_symbolic_factors),     cmocka_unit_test(test_scales_of_pivots),
      cmocka_unit_test(test_rotations_about_axes),
  };
  return cmocka_run_group_tests_name("inertia", tests, NULL, NULL);
}
