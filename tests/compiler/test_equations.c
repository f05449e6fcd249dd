/* Equations of motion, energies and linearizations of small systems, against derivations by hand. */
#include <stdio.h>
#include <unistd.h>

#include "base/memory.h"
#include "expressions.h"
#include "mechanics/mass_matrix/inertia.h"
#include "mechanics/lagrange.h"
#include "mechanics/linearize.h"
#include "read/reader.h"

/* A system, and its linearization if a point is given. */
struct Derived {
  struct Diagnostics diagnostics;
  struct Model *model;
  struct Equations *equations, *linear;
};

enum { POINT_LIMIT = 8 };

/* Reads a file with this text. point: "name=value ..." for a linearization, or NULL. */
static struct Model *read_text(const char *text, const char *point, struct Diagnostics *diagnostics) {
  char path[] = "/tmp/equationsXXXXXX", *words = point == NULL ? NULL : copy_text(point);
  const char *names[POINT_LIMIT];
  size_t count = 0;
  int descriptor = mkstemp(path);
  assert_true(descriptor >= 0 && write(descriptor, text, strlen(text)) == (ssize_t)strlen(text));
  close(descriptor);
  for (char *word = words == NULL ? NULL : strtok(words, " "); word != NULL; word = strtok(NULL, " ")) {
    assert_true(count < POINT_LIMIT);
    names[count++] = word;
  }
  struct ReaderOptions options = {.point = names, .point_count = count, .linearize = point != NULL};
  struct Model *model = model_read(path, &options, diagnostics);
  unlink(path);
  return model;
}

/* Derives a system. Errors are counted in the diagnostics; results that they prevent are NULL. */
static struct Derived derive(const char *text, const char *point) {
  struct Derived derived = {.diagnostics = {.file = "test"}};
  derived.model = read_text(text, point, &derived.diagnostics);
  if (derived.model != NULL) derived.equations = equations_derive(derived.model, &derived.diagnostics);
  if (derived.equations != NULL && point != NULL)
    derived.linear = linearize(derived.model, derived.equations, &derived.diagnostics);
  return derived;
}

struct Override {
  const char *name;
  double value;
};

/* Returns the value of a node for the given values of symbols; the others have their start values. */
static double value_of(const struct Derived *derived, Node node, const struct Override *given, size_t count) {
  const struct Graph *graph = derived->model->graph;
  double *symbols = start_values(derived->model);
  for (size_t k = 0; k < count; k++) {
    size_t i = 0;
    while (strcmp(graph->symbols[i].name, given[k].name) != 0) assert_true(++i < graph->symbol_count);
    symbols[i] = given[k].value;
  }
  double *values = graph_evaluate(graph, symbols), value = values[node];
  return value;
}

static void assert_value(const struct Derived *derived, Node node, const struct Override *given, size_t count,
                         double expected, double tolerance) {
  double value = value_of(derived, node, given, count);
  if (!(fabs(value - expected) <= tolerance)) fail_msg("%.17g, expected %.17g", value, expected);
}

/* A charge in a magnetic field: terms linear in velocities bend the path and store no energy. */
static void test_magnetic_terms(void **state) {
  (void)state;
  struct Derived charge =
      derive("<system name='Charge'><parameter name='m' start='2'/><parameter name='q' start='3'/>"
             "<parameter name='k' start='5'/><coordinate name='x' velocity='v'/><coordinate name='y' velocity='w'/>"
             "<particle name='p' mass='m' x='x' y='y'/><potential>k*x^2/2 - q*x*w</potential></system>",
             NULL);
  const struct Override at[] = {{"x", 0.3}, {"y", -0.7}, {"v", 1.1}, {"w", 1.7}, {"der(v)", 0.4}, {"der(w)", -0.9}};
  assert_int_equal(charge.diagnostics.errors, 0);
  const struct Equations *equations = charge.equations;
  assert_value(&charge, equations->potential, at, 6, 2.5 * 0.09, 1e-14);
  assert_value(&charge, equations->kinetic, at, 6, 1.21 + 2.89, 1e-14);
  assert_value(&charge, equations->total, at, 6, 1.21 + 2.89 + 2.5 * 0.09, 1e-14);
  /* m v' = -k x + q w,  m w' = -q v */
  assert_value(&charge, equations->acceleration[0], at, 6, (-1.5 + 5.1) / 2, 1e-14);
  assert_value(&charge, equations->acceleration[1], at, 6, -3.3 / 2, 1e-14);
  assert_value(&charge, equations->residual[0], at, 6, 0.8 + 1.5 - 5.1, 1e-14);
  assert_value(&charge, equations->residual[1], at, 6, -1.8 + 3.3, 1e-14);
}

/* A cart with a hanging rod, a wheel on the cart, and a spring. */
#define CART                                                                                                           \
  "<system name='Cart'><parameter name='m' start='2'/><parameter name='g' start='9'/><input name='F'/>"                \
  "<coordinate name='x' velocity='v'/><coordinate name='theta' velocity='omega'/>"                                     \
  "<body name='cart' mass='3' x='x' inertia='m/4' angle='x^2'/>"                                                       \
  "<particle name='bob' mass='m' x='x + sin(theta)' y='-cos(theta)'/><potential>m*g*bob.y + 5*x^4</potential>"         \
  "<force coordinate='x'>F*x</force><output name='o'>x*theta*F</output></system>"

struct Motion {
  long double x, theta, v, omega, F;
};

/* The same, written by hand. */
static long double kinetic_of_cart(const struct Motion *at) {
  long double wheel = 2 * at->x * at->v, across = at->v + cosl(at->theta) * at->omega;
  long double along = sinl(at->theta) * at->omega;
  return 1.5L * at->v * at->v + 0.25L * wheel * wheel + across * across + along * along;
}

static long double potential_of_cart(const struct Motion *at) {
  return -18 * cosl(at->theta) + 5 * at->x * at->x * at->x * at->x;
}

static long double bob_of_cart(const struct Motion *at) {
  return at->x + sinl(at->theta);
}

static long double angle_of_cart(const struct Motion *at) {
  return at->x * at->x;
}

static long double output_of_cart(const struct Motion *at) {
  return at->x * at->theta * at->F;
}

typedef long double OfMotion(const struct Motion *);

/* Returns the Taylor polynomial at the point for the deviation, by difference quotients along it. */
static double polynomial(OfMotion *of, const struct Motion *point, const struct Motion *deviation, int order) {
  const long double h = 1e-3L;
  long double values[5], first, second;
  for (int i = 0; i < 5; i++) {
    long double s = (i - 2) * h;
    struct Motion at = {point->x + s * deviation->x, point->theta + s * deviation->theta, point->v + s * deviation->v,
                        point->omega + s * deviation->omega, point->F + s * deviation->F};
    values[i] = of(&at);
  }
  first = (values[0] - 8 * values[1] + 8 * values[3] - values[4]) / (12 * h);
  second = (-values[0] + 16 * values[1] - 30 * values[2] + 16 * values[3] - values[4]) / (12 * h * h);
  return (double)(values[2] + first + (order == 2 ? second / 2 : 0));
}

/* Positions and outputs to first order, energies to second, about a point that is not an equilibrium. */
static void test_linearization(void **state) {
  (void)state;
  struct Derived cart = derive(CART, "x=2 theta=1 v=0.5 omega=-1.5 F=4");
  const struct Motion point = {2, 1, 0.5L, -1.5L, 4}, deviation = {0.3L, -0.2L, 0.7L, 0.4L, -1};
  const struct Override at[] = {{"x", 2.3}, {"theta", 0.8}, {"v", 1.2}, {"omega", -1.1}, {"F", 3}};
  assert_int_equal(cart.diagnostics.errors, 0);
  const struct Equations *linear = cart.linear;
  const struct {
    Node node;
    OfMotion *of;
    int order;
  } cases[] = {{linear->kinetic, kinetic_of_cart, 2},
               {linear->potential, potential_of_cart, 2},
               {linear->outputs[0], output_of_cart, 1},
               {linear->element_variables[1] /* cart.angle */, angle_of_cart, 1},
               {linear->element_variables[2] /* bob.x */, bob_of_cart, 1}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    assert_value(&cart, cases[i].node, at, 5, polynomial(cases[i].of, &point, &deviation, cases[i].order), 1e-8);
}

/*
 * (5 + 2 x^2) a + 2 cos(theta) alpha = F x - 20 x^3 - 2 x v^2 + 2 sin(theta) omega^2,  2 cos(theta) a + 2 alpha = -18
 * sin(theta)
 */
static void test_equations_of_coupled_coordinates(void **state) {
  (void)state;
  struct Derived cart = derive(CART, NULL);
  assert_int_equal(cart.diagnostics.errors, 0);
  const double x = 0.6, theta = 2.5, v = 1.2, omega = -1.1, force = 3, a = 0.7, alpha = -1.9;
  const struct Override at[] = {{"x", x},      {"theta", theta},     {"v", v}, {"omega", omega}, {"F", force},
                                {"der(v)", a}, {"der(omega)", alpha}};
  double m[2][2] = {{5 + 2 * x * x, 2 * cos(theta)}, {2 * cos(theta), 2}};
  double right[] = {force * x - 20 * x * x * x - 2 * x * v * v + 2 * sin(theta) * omega * omega, -18 * sin(theta)};
  double determinant = m[0][0] * m[1][1] - m[0][1] * m[1][0];
  for (int i = 0; i < 2; i++) {
    double solution = (m[1 - i][1 - i] * right[i] - m[i][1 - i] * right[1 - i]) / determinant;
    assert_value(&cart, cart.equations->acceleration[i], at, 7, solution, 1e-13);
    assert_value(&cart, cart.equations->right_side[i], at, 7, right[i], 1e-13);
    assert_value(&cart, cart.equations->residual[i], at, 7, m[i][0] * a + m[i][1] * alpha - right[i], 1e-13);
  }
}

/* (q + s)^2 - (q - s)^2 - 4 q s: an element that vanishes only when expanded couples nothing. */
static void test_elements_that_vanish(void **state) {
  (void)state;
  struct Derived pair =
      derive("<system name='Pair'><coordinate name='q' velocity='v'/><coordinate name='s' velocity='w'/>"
             "<particle mass='1' x='(q + s)^2/2' y='(q - s)^2/2'/><kinetic>v^2 + w^2 - 4*q*s*v*w</kinetic></system>",
             NULL);
  assert_int_equal(pair.diagnostics.errors, 0);
  assert_int_equal(pair.equations->inertia->block_count, 2);
  assert_int_equal(inertia_element(pair.equations->inertia, 0, 1), ZERO);
  const struct Override at[] = {{"q", 0.3}, {"s", 0.8}};
  assert_value(&pair, inertia_element(pair.equations->inertia, 1, 1), at, 2, 2 + 1.21 + 0.25, 1e-14);
}

/* theta'' = -9 sin(theta) + u cos(theta), about theta = 1 and u = 2. */
static void test_linear_system_with_its_constant(void **state) {
  (void)state;
  struct Derived rod = derive(
      "<system name='Rod'><parameter name='m' start='2'/><input name='u'/><coordinate name='theta' velocity='omega'/>"
      "<particle name='bob' mass='m' x='sin(theta)' y='-cos(theta)'/><potential>9*m*bob.y</potential>"
      "<force coordinate='theta'>m*u*cos(theta)</force></system>",
      "theta=1 u=2");
  assert_int_equal(rod.diagnostics.errors, 0);
  double slope = -9 * cos(1) - 2 * sin(1), value = -9 * sin(1) + 2 * cos(1);
  const struct Override at[] = {{"theta", 1.3}, {"omega", 5}, {"u", 1.5}};
  assert_value(&rod, rod.linear->acceleration[0], at, 3, value + 0.3 * slope - 0.5 * cos(1), 1e-14);
  struct LinearSystem *system = linear_system_of(rod.model, rod.linear, &rod.diagnostics);
  const double a[] = {0, 1, slope, 0}, b[] = {0, cos(1)}, c[] = {0, value - slope - 2 * cos(1)};
  for (int i = 0; i < 4; i++) assert_value(&rod, system->a[i], NULL, 0, a[i], 1e-14);
  for (int i = 0; i < 2; i++) assert_value(&rod, system->b[i], NULL, 0, b[i], 1e-14);
  for (int i = 0; i < 2; i++) assert_value(&rod, system->c[i], NULL, 0, c[i], 1e-14);
}

#define SPRING(force)                                                                                                  \
  "<system name='Spring'><coordinate name='x' velocity='v'/><particle mass='2' x='x'/><force coordinate='x'>" force    \
  "</force></system>"

static void test_systems_that_are_not_linear(void **state) {
  (void)state;
  static const struct {
    const char *text;
    bool is_linear;
  } cases[] = {{SPRING("3 - x - 2*v"), true}, {SPRING("sin(time) - x"), false}, {SPRING("-x*time"), false},
               {SPRING("-x^3"), false},       {SPRING("x*v"), false},           {SPRING("-abs(v)"), false}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct Derived spring = derive(cases[i].text, NULL);
    assert_int_equal(spring.diagnostics.errors, 0);
    struct LinearSystem *system = linear_system_of(spring.model, spring.equations, &spring.diagnostics);
    assert_true((system != NULL) == cases[i].is_linear && (spring.diagnostics.errors == 0) == cases[i].is_linear);
  }
}

static void test_points_without_a_linearization(void **state) {
  (void)state;
  const char *const polar =
      "<system name='Polar'><coordinate name='r' velocity='v'/><coordinate name='phi' velocity='w'/>"
      "<particle mass='2' x='r*cos(phi)' y='r*sin(phi)'/></system>";
  const char *const driven =
      "<system name='Driven'><coordinate name='x' velocity='v'/><particle mass='2' x='x + sin(time)'/>"
      "</system>";
  struct Derived pole = derive(polar, "r=0"), right = derive(polar, "r=1"), in_time = derive(driven, "x=0");
  assert_true(pole.linear == NULL && pole.diagnostics.errors == 1);
  assert_true(right.linear != NULL && right.diagnostics.errors == 0);
  assert_true(in_time.linear == NULL && in_time.diagnostics.errors == 1);
}

/* Masses in a ring, each tied to the ground, with inerters between neighbours: the elimination of M has fill-in. */
#define RING(count, ground)                                                                                            \
  "<system name='Ring'><constant name='N' value='" #count "'/><for index='i' from='1' to='N'>"                         \
  "<coordinate name='x[i]' velocity='v[i]'/><potential>i*x[i]^2/2</potential></for>"                                   \
  "<for index='i' from='2' to='N'><kinetic>i*(v[i] - v[i-1])^2/2</kinetic></for>"                                      \
  "<kinetic>(v[1] - v[N])^2/2" ground "</kinetic></system>"

enum { RING_SIZE = 5 };

/* A linearization of any size is solved symbolically: M a = -i x_i. */
static void test_symbolic_solution_of_larger_systems(void **state) {
  (void)state;
  struct Derived ring = derive(RING(5, " + v[1]^2"), "x[1]=0");
  assert_int_equal(ring.diagnostics.errors, 0);
  assert_int_equal(ring.equations->inertia->block_count, 1);
  const struct Override at[] = {{"x[1]", 0.3}, {"x[2]", -0.2}, {"x[3]", 0.9}, {"x[4]", 1.7}, {"x[5]", -2.1}};
  double a[RING_SIZE], m[RING_SIZE][RING_SIZE] = {{0}};
  for (int i = 0; i < RING_SIZE; i++) {
    int before = (i + RING_SIZE - 1) % RING_SIZE, stiffness = i == 0 ? 1 : i + 1;
    m[i][i] += stiffness;
    m[before][before] += stiffness;
    m[i][before] -= stiffness;
    m[before][i] -= stiffness;
    a[i] = value_of(&ring, ring.linear->acceleration[i], at, RING_SIZE);
  }
  m[0][0] += 2;
  for (int i = 0; i < RING_SIZE; i++) {
    double sum = (i + 1) * at[i].value;
    for (int j = 0; j < RING_SIZE; j++) sum += m[i][j] * a[j];
    assert_true(fabs(sum) < 1e-12);
  }
}

/* Without masses the ring as a whole moves freely, without kinetic energy. */
static void test_mass_matrices_that_are_singular_everywhere(void **state) {
  (void)state;
  struct Derived free_ring = derive(RING(9, ""), NULL), damped_ring = derive(RING(9, " + 1e-3*v[1]^2"), NULL);
  assert_true(free_ring.equations == NULL && free_ring.diagnostics.errors == 1);
  assert_true(damped_ring.equations != NULL && damped_ring.diagnostics.errors == 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_magnetic_terms),
      cmocka_unit_test(test_equations_of_coupled_coordinates),
      cmocka_unit_test(test_elements_that_vanish),
      cmocka_unit_test(test_linearization),
      cmocka_unit_test(test_linear_system_with_its_constant),
      cmocka_unit_test(test_systems_that_are_not_linear),
      cmocka_unit_test(test_points_without_a_linearization),
      cmocka_unit_test(test_symbolic_solution_of_larger_systems),
      cmocka_unit_test(test_mass_matrices_that_are_singular_everywhere),
  };
  return cmocka_run_group_tests_name("equations", tests, NULL, NULL);
}
