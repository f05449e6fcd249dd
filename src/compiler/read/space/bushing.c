#include "read/context/readers.h"

#include <string.h>

#include "algebra/simplify.h"
#include "base/memory.h"
#include "read/space/joint_ends.h"

enum { X, Y, Z };

/* Reads one factor for all axes, or three separated by blanks; 0 if the attribute is missing. */
static struct Vector read_factors(struct Reader *reader, xmlNodePtr node, const char *name, const char *unit) {
  struct Vector factors = {{ZERO, ZERO, ZERO}};
  char *text = attribute(node, name), *rest = NULL;
  const char *what = format_text("the %s of <bushing>", name);
  int count = 0;
  for (char *part = text != NULL ? strtok_r(text, " \t\r\n", &rest) : NULL; part != NULL;
       part = strtok_r(NULL, " \t\r\n", &rest)) {
    struct Quantity factor = parse_expression(reader->scope, part, location_of(node, what, IN_MASS));
    require_unit(reader, line_of_attribute(node, what), what, factor, unit_of(unit));
    expect_not_negative(reader, node, what, factor.node, false);
    if (count < 3) factors.along[count] = factor.node;
    count++;
  }
  if (count == 1) factors.along[Y] = factors.along[Z] = factors.along[X];
  if (text != NULL && count != 1 && count != 3)
    report_at(reader, node, "%s has %d parts; expected one, or three between blanks, without blanks in them", what,
              count);
  return factors;
}

static bool is_zero(struct Vector vector) {
  return vector.along[X] == ZERO && vector.along[Y] == ZERO && vector.along[Z] == ZERO;
}

/* Returns the sum of factor value^2 / 2 over the axes. */
static Node half_of_squares(struct Graph *graph, struct Vector factors, struct Vector values) {
  Node sum = ZERO;
  for (int i = 0; i < 3; i++) {
    Node square = power_number(graph, values.along[i], 2.0);
    sum = add(graph, sum, scale(graph, 0.5, multiply(graph, factors.along[i], square)));
  }
  return sum;
}

static struct Vector stretch_of(struct Graph *graph, const struct JointEnd *from, const struct JointEnd *to) {
  struct Vector stretch;
  for (int i = 0; i < 3; i++) stretch.along[i] = offset_along(graph, from, to, i);
  return stretch;
}

/*
 * Returns 2 sin(angle/2) times the unit axis of the relative rotation R: twice the vector part of its unit quaternion,
 * (R[k][j] - R[j][k]) / sqrt(1 + trace R) for cyclic i, j, k. It is smooth except at half turns.
 */
static struct Vector twist_of(struct Graph *graph, const struct JointEnd *from, const struct JointEnd *to) {
  struct Vector twist;
  Node trace = ONE;
  for (int i = 0; i < 3; i++) trace = add(graph, trace, product_of_axes(graph, from, i, to, i));
  Node factor = power_number(graph, trace, -0.5);
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    Node forth = product_of_axes(graph, from, k, to, j), back = product_of_axes(graph, from, j, to, k);
    twist.along[i] = multiply(graph, factor, subtract(graph, forth, back));
  }
  return twist;
}

/* Returns the angular velocity of `to` relative to `from`, along the axes of `from`. */
static struct Vector spin_of(struct Reader *reader, const struct JointEnd *from, const struct JointEnd *to) {
  struct Graph *graph = reader->model->graph;
  const struct ReferenceFrame *frames = reader->model->mechanism.frames;
  struct Vector ours = matrix_apply(graph, &to->rotation, frames[to->frame].pose.angular_velocity);
  struct Vector spin = matrix_apply_transposed(graph, &from->rotation, ours);
  Node minus = graph_constant(graph, -1.0);
  return vector_add(graph, spin, vector_scale(graph, minus, frames[from->frame].pose.angular_velocity));
}

static void add_springs(struct Reader *reader, xmlNodePtr node, struct Vector factors, struct Vector values) {
  struct Energies *energies = &reader->model->energies;
  Node energy = half_of_squares(reader->model->graph, factors, values);
  if (!is_zero(factors) && graph_is_constant_in_time(reader->model->graph, energy))
    report_at(reader, node,
              "the energy of <bushing> is the same at all times; expected '%s' and '%s' that move or rotate",
              attribute(node, "from"), attribute(node, "to"));
  else if (!is_zero(factors))
    add_energy(reader, node, "the energy of <bushing>", energy, &energies->displaced_potential, &energies->potential);
}

static void add_dampers(struct Reader *reader, xmlNodePtr node, struct Vector factors, struct Vector rates) {
  struct Energies *energies = &reader->model->energies;
  if (is_zero(factors)) return;
  add_energy(reader, node, "the dissipation of <bushing>", half_of_squares(reader->model->graph, factors, rates),
             &energies->displaced_dissipation, &energies->dissipation);
  reader->model->forces.any = true;
}

void read_bushing(struct Reader *reader, xmlNodePtr node) {
  struct Graph *graph = reader->model->graph;
  struct JointEnd from, to;
  struct Vector stiffness = read_factors(reader, node, "stiffness", "N/m");
  struct Vector damping = read_factors(reader, node, "damping", "N.s/m");
  struct Vector torsion = read_factors(reader, node, "torsion", "N.m/rad");
  struct Vector torsion_damping = read_factors(reader, node, "torsionDamping", "N.m.s/rad");
  bool is_right = read_displaced_joint_end(reader, node, "from", &from);
  is_right &= read_displaced_joint_end(reader, node, "to", &to);
  if (!is_right || reader->diagnostics->errors > 0) return;
  if (is_zero(stiffness) && is_zero(damping) && is_zero(torsion) && is_zero(torsion_damping))
    report_at(reader, node, "<bushing> has neither stiffness nor damping, torsion nor torsionDamping; expected one");
  struct Vector stretch = stretch_of(graph, &from, &to), rate;
  add_springs(reader, node, stiffness, stretch);
  for (int i = 0; i < 3; i++) rate.along[i] = total_time_derivative(reader->scope, stretch.along[i]);
  add_dampers(reader, node, damping, rate);
  if (!is_zero(torsion)) add_springs(reader, node, torsion, twist_of(graph, &from, &to));
  if (!is_zero(torsion_damping)) add_dampers(reader, node, torsion_damping, spin_of(reader, &from, &to));
}
