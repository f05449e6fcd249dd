#include "read/shapes/tangents.h"

#include "algebra/simplify.h"

/*
 * Orthonormal vectors, parallel to no axis of the base: normals of shapes that are placed along those axes are never
 * opposite to the third vector.
 */
static const double generic_axes[3][3] = {
    {2.0 / 3.0, -2.0 / 3.0, 1.0 / 3.0}, {2.0 / 3.0, 1.0 / 3.0, -2.0 / 3.0}, {1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0}};

/* Returns the velocity of the material of a shape at a point, along the base's axes. */
static struct Vector velocity_of_material(struct Reader *reader, const struct ContactSide *side, struct Vector point) {
  struct Graph *graph = reader->model->graph;
  struct Vector spin = matrix_apply(graph, &side->pose.rotation, side->pose.angular_velocity), velocity;
  for (int i = 0; i < 3; i++) velocity.along[i] = total_time_derivative(reader->scope, side->pose.origin.along[i]);
  struct Vector lever_arm = vector_subtract(graph, point, side->pose.origin);
  return vector_add(graph, velocity, vector_cross(graph, spin, lever_arm));
}

static struct Vector tilted_axis(struct Graph *graph, int which) {
  struct Vector axis;
  for (int i = 0; i < 3; i++) axis.along[i] = graph_constant(graph, generic_axes[which][i]);
  return axis;
}

/* Returns the two axes of the plane along the base's axes. */
static void tangents_of_plane(struct Graph *graph, const struct ContactSide *plane, struct Vector tangents[2]) {
  for (int i = 0; i < 2; i++) {
    struct Vector axis = {{ZERO, ZERO, ZERO}};
    axis.along[(plane->shape->axis + 1 + i) % 3] = ONE;
    axis = matrix_apply(graph, &plane->shape->rotation, axis);
    tangents[i] = matrix_apply(graph, &plane->pose.rotation, axis);
  }
}

/*
 * If the normal is always perpendicular to an axis of the base, sets the tangents to this axis and the vector
 * perpendicular to both. Returns false otherwise.
 */
static bool tangents_in_plane(struct Graph *graph, struct Vector normal, struct Vector tangents[2]) {
  for (int i = 0; i < 3; i++) {
    if (normal.along[i] != ZERO) continue;
    tangents[1] = (struct Vector){{ZERO, ZERO, ZERO}};
    tangents[1].along[i] = ONE;
    tangents[0] = vector_cross(graph, tangents[1], normal);
    return true;
  }
  return false;
}

/*
 * Rotates two oblique axes e by the shortest rotation of the third one, e3, to the normal n: e - (n . e) / (1 + n . e3)
 * (n + e3).
 */
static void tangents_of_normal(struct Graph *graph, struct Vector normal, struct Vector tangents[2]) {
  struct Vector third = tilted_axis(graph, 2), both = vector_add(graph, normal, third);
  Node whole = add(graph, ONE, vector_dot(graph, normal, third));
  for (int i = 0; i < 2; i++) {
    struct Vector axis = tilted_axis(graph, i);
    Node share = divide(graph, vector_dot(graph, normal, axis), whole);
    tangents[i] = vector_subtract(graph, axis, vector_scale(graph, share, both));
  }
}

struct Slip slip_of_contact(struct Reader *reader, const struct ContactSide *first, const struct ContactSide *second,
                            const struct ContactPoint *point) {
  struct Graph *graph = reader->model->graph;
  struct Vector tangents[2];
  struct Vector velocity = vector_subtract(graph, velocity_of_material(reader, first, point->point),
                                           velocity_of_material(reader, second, point->point));
  if (second->shape->type == SHAPE_PLANE) tangents_of_plane(graph, second, tangents);
  else if (first->shape->type == SHAPE_PLANE) tangents_of_plane(graph, first, tangents);
  else if (!tangents_in_plane(graph, point->normal, tangents)) tangents_of_normal(graph, point->normal, tangents);
  return (struct Slip){vector_dot(graph, velocity, tangents[0]), vector_dot(graph, velocity, tangents[1])};
}
