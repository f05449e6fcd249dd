#include "read/space/rolling.h"

#include <math.h>

#include "algebra/simplify.h"

enum { X, Y, Z };

/* Reads a nonzero length, an expression of parameters. */
static Node read_length(struct Reader *reader, xmlNodePtr node, const char *name) {
  struct Quantity length = {.node = ZERO};
  if (!expression_attribute(reader, node, name, IN_MASS, &length)) return ONE; /* the error has been reported */
  require_unit(reader, line_of_attribute(node, name), name, length, unit_of("m"));
  if (length.node == ZERO) report_at(reader, node, "the %s of <joint> is 0; expected a length", name);
  return length.node == ZERO ? ONE : length.node;
}

/* lead: pitch/(2 pi). sine, cosine: of 2 pi z/pitch - angle, by the addition theorems from products of axes. */
struct ScrewThread {
  Node lead, sine, cosine;
};

static struct ScrewThread read_thread(struct Reader *reader, xmlNodePtr node, const struct JointEnd *from,
                                      const struct JointEnd *to) {
  struct Graph *graph = reader->model->graph;
  Node lead = scale(graph, 0.5 / M_PI, read_length(reader, node, "pitch"));
  Node fitting = divide(graph, offset_along(graph, from, to, Z), lead);
  Node sine = function(graph, SINE, fitting, ZERO), cosine = function(graph, COSINE, fitting, ZERO);
  Node along = product_of_axes(graph, from, X, to, X), across = product_of_axes(graph, from, Y, to, X);
  return (struct ScrewThread){
      .lead = lead,
      .sine = subtract(graph, multiply(graph, sine, along), multiply(graph, cosine, across)),
      .cosine = add(graph, multiply(graph, cosine, along), multiply(graph, sine, across)),
  };
}

/* Returns lead sin(2 pi z/pitch - angle), which is smooth, unlike the angle itself. */
Node thread_of(struct Reader *reader, xmlNodePtr node, const struct JointEnd *from, const struct JointEnd *to) {
  struct ScrewThread thread = read_thread(reader, node, from, to);
  return multiply(reader->model->graph, thread.lead, thread.sine);
}

Node slope_of_thread(struct Reader *reader, xmlNodePtr node, const struct JointEnd *from, const struct JointEnd *to) {
  return read_thread(reader, node, from, to).cosine;
}

bool can_roll(struct Reader *reader, xmlNodePtr node, const struct JointEnd *to) {
  if (!to->has_axes)
    report_at(reader, node, "'%s' has no axes and cannot roll; expected a <frame> or <body>", attribute(node, "to"));
  return to->has_axes;
}

static bool is_sphere(xmlNodePtr node) {
  return attribute_is(node, "shape", "sphere");
}

/* Cosine and sine of the angle between the plane's normal and the wheel's axis. */
struct Tilt {
  Node cosine, sine;
};

static struct Tilt tilt_of(struct Graph *graph, const struct JointEnd *from, const struct JointEnd *to) {
  Node cosine = product_of_axes(graph, from, Z, to, Z);
  Node square = subtract(graph, ONE, power_number(graph, cosine, 2.0));
  return (struct Tilt){cosine, power_number(graph, square, 0.5)};
}

Node height_of(struct Reader *reader, xmlNodePtr node, const struct JointEnd *from, const struct JointEnd *to) {
  struct Graph *graph = reader->model->graph;
  Node radius = read_length(reader, node, "radius"), centre = offset_along(graph, from, to, Z);
  if (is_sphere(node)) return subtract(graph, centre, radius);
  return subtract(graph, centre, multiply(graph, radius, tilt_of(graph, from, to).sine));
}

/* Returns the vector from the centre to the lowest point: downward, and for a wheel perpendicular to its axis. */
static struct Vector lever_arm_of(struct Graph *graph, xmlNodePtr node, Node radius, const struct JointEnd *from,
                                  const struct JointEnd *to) {
  struct Vector up = axis_of_end(from, Z);
  if (is_sphere(node)) return vector_scale(graph, negate(graph, radius), up);
  struct Tilt tilt = tilt_of(graph, from, to);
  struct Vector axle = vector_scale(graph, tilt.cosine, axis_of_end(to, Z));
  struct Vector across = vector_subtract(graph, axle, up);
  return vector_scale(graph, divide(graph, radius, tilt.sine), across);
}

/*
 * Returns the velocity, along the base's axes, of the point that is fixed to the end at the vector jacobian_row from
 * it.
 */
static struct Vector velocity_of(struct Reader *reader, xmlNodePtr node, const struct JointEnd *end,
                                 struct Vector lever_arm) {
  struct Graph *graph = reader->model->graph;
  struct Vector spin = angular_velocity_of_end(reader, node, end), velocity;
  for (int i = 0; i < 3; i++) velocity.along[i] = total_time_derivative(reader->scope, end->position.along[i]);
  return vector_add(graph, velocity, vector_cross(graph, spin, lever_arm));
}

Node slip_of(struct Reader *reader, xmlNodePtr node, const struct JointEnd *from, const struct JointEnd *to, int axis) {
  struct Graph *graph = reader->model->graph;
  Node radius = read_length(reader, node, "radius"), minus = graph_constant(graph, -1.0);
  struct Vector lever_arm = lever_arm_of(graph, node, radius, from, to);
  struct Vector between = vector_add(graph, to->position, vector_scale(graph, minus, from->position));
  struct Vector ground = velocity_of(reader, node, from, vector_add(graph, between, lever_arm));
  struct Vector rim = velocity_of(reader, node, to, lever_arm);
  return vector_dot(graph, axis_of_end(from, axis), vector_add(graph, rim, vector_scale(graph, minus, ground)));
}
