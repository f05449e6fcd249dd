#include "mechanics/mass_matrix/spatial.h"

#include "algebra/simplify.h"
#include "mechanics/mass_matrix/rotated.h"

const struct SpatialVector spatial_zero = {{{ZERO, ZERO, ZERO}}, {{ZERO, ZERO, ZERO}}};

struct SpatialVector spatial_add(struct Graph *graph, struct SpatialVector a, struct SpatialVector b) {
  struct Vector linear = vector_add(graph, a.linear, b.linear);
  return (struct SpatialVector){linear, vector_add(graph, a.angular, b.angular)};
}

struct SpatialVector spatial_scale(struct Graph *graph, Node factor, struct SpatialVector a) {
  struct Vector linear = vector_scale(graph, factor, a.linear);
  return (struct SpatialVector){linear, vector_scale(graph, factor, a.angular)};
}

Node spatial_dot(struct Graph *graph, struct SpatialVector force, struct SpatialVector motion) {
  Node linear = vector_dot(graph, force.linear, motion.linear);
  return add(graph, linear, vector_dot(graph, force.angular, motion.angular));
}

static struct Matrix matrix_add(struct Graph *graph, const struct Matrix *a, const struct Matrix *b) {
  struct Matrix sum;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) sum.row[i].along[j] = add_whole(graph, a->row[i].along[j], b->row[i].along[j]);
  return sum;
}

/* Returns [r] matrix, where [r] x is the cross product of r and x. */
static struct Matrix crossed(struct Graph *graph, struct Vector r, const struct Matrix *matrix) {
  struct Matrix columns = matrix_transposed(matrix);
  for (int i = 0; i < 3; i++) columns.row[i] = vector_cross(graph, r, columns.row[i]);
  return matrix_transposed(&columns);
}

/* Copies the upper triangle of a symmetric matrix to the lower one, so that both have the same nodes. */
static void mirror(struct Matrix *matrix) {
  for (int i = 1; i < 3; i++)
    for (int j = 0; j < i; j++) matrix->row[i].along[j] = matrix->row[j].along[i];
}

struct SpatialInertia spatial_inertia_of_body(struct Graph *graph, Node mass, struct Vector offset,
                                              const struct Matrix *tensor) {
  struct SpatialInertia inertia = {0};
  struct Vector first_moment = vector_scale(graph, mass, offset);
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    inertia.mass.row[i].along[i] = mass;
    inertia.coupling.row[i].along[j] = first_moment.along[k]; /* the matrix of -(mass offset) x */
    inertia.coupling.row[j].along[i] = negate(graph, first_moment.along[k]);
    Node square = multiply(graph, first_moment.along[j], offset.along[j]);
    square = add(graph, square, multiply(graph, first_moment.along[k], offset.along[k]));
    inertia.moment.row[i].along[i] = add(graph, tensor->row[i].along[i], square);
    Node product = multiply(graph, first_moment.along[i], offset.along[j]);
    inertia.moment.row[i].along[j] = subtract(graph, tensor->row[i].along[j], product);
    inertia.moment.row[j].along[i] = inertia.moment.row[i].along[j];
  }
  return inertia;
}

struct SpatialInertia spatial_inertia_add(struct Graph *graph, const struct SpatialInertia *a,
                                          const struct SpatialInertia *b) {
  struct SpatialInertia sum = {.mass = matrix_add(graph, &a->mass, &b->mass)};
  sum.coupling = matrix_add(graph, &a->coupling, &b->coupling);
  sum.moment = matrix_add(graph, &a->moment, &b->moment);
  return sum;
}

/* Returns matrix - column row^T. */
static struct Matrix subtract_outer_product(struct Graph *graph, struct Matrix matrix, struct Vector column,
                                            struct Vector row) {
  for (int i = 0; i < 3; i++)
    matrix.row[i] = vector_subtract(graph, matrix.row[i], vector_scale(graph, column.along[i], row));
  return matrix;
}

struct SpatialInertia spatial_inertia_subtract(struct Graph *graph, const struct SpatialInertia *inertia,
                                               struct SpatialVector gain, struct SpatialVector force) {
  struct SpatialInertia rest = {.mass = subtract_outer_product(graph, inertia->mass, gain.linear, force.linear)};
  rest.coupling = subtract_outer_product(graph, inertia->coupling, gain.linear, force.angular);
  rest.moment = subtract_outer_product(graph, inertia->moment, gain.angular, force.angular);
  mirror(&rest.mass);
  mirror(&rest.moment);
  return rest;
}

struct SpatialVector spatial_inertia_apply(struct Graph *graph, const struct SpatialInertia *inertia,
                                           struct SpatialVector motion) {
  struct SpatialVector force;
  force.linear = matrix_apply(graph, &inertia->mass, motion.linear);
  force.linear = vector_add(graph, force.linear, matrix_apply(graph, &inertia->coupling, motion.angular));
  force.angular = matrix_apply_transposed(graph, &inertia->coupling, motion.linear);
  force.angular = vector_add(graph, force.angular, matrix_apply(graph, &inertia->moment, motion.angular));
  return force;
}

/*
 * Computes T^T inertia T for T = (1 -[r]; 0 1), with the inertia in the parent's axes and r from the parent's
 * origin. The coupling is coupling - mass [r]; the moment is moment - coupling^T [r] + [r] (coupling - mass [r]).
 */
struct SpatialInertia spatial_inertia_to_parent(struct Graph *graph, const struct Pose *pose,
                                                const struct SpatialInertia *inertia) {
  struct Vector r = pose->origin;
  struct SpatialInertia result = {.mass = matrix_rotated(graph, &pose->rotation, &inertia->mass)};
  mirror(&result.mass);
  struct Matrix coupling = matrix_rotated(graph, &pose->rotation, &inertia->coupling);
  struct Matrix moment = matrix_rotated(graph, &pose->rotation, &inertia->moment);
  /* (X [r])^T = -[r] X^T */
  struct Matrix first_moment = crossed(graph, r, &result.mass);
  first_moment = matrix_transposed(&first_moment);
  result.coupling = matrix_add(graph, &coupling, &first_moment);
  struct Matrix first = crossed(graph, r, &coupling), second = crossed(graph, r, &result.coupling);
  first = matrix_transposed(&first);
  moment = matrix_add(graph, &moment, &first);
  result.moment = matrix_add(graph, &moment, &second);
  mirror(&result.moment);
  return result;
}

struct SpatialVector spatial_force_to_parent(struct Graph *graph, const struct Pose *pose, struct SpatialVector force) {
  struct SpatialVector result = {.linear = matrix_apply(graph, &pose->rotation, force.linear)};
  result.angular = matrix_apply(graph, &pose->rotation, force.angular);
  result.angular = vector_add(graph, result.angular, vector_cross(graph, pose->origin, result.linear));
  return result;
}

struct SpatialVector spatial_motion_from_parent(struct Graph *graph, const struct Pose *pose,
                                                struct SpatialVector motion) {
  struct Vector carried = vector_add(graph, motion.linear, vector_cross(graph, motion.angular, pose->origin));
  struct SpatialVector result = {.linear = matrix_apply_transposed(graph, &pose->rotation, carried)};
  result.angular = matrix_apply_transposed(graph, &pose->rotation, motion.angular);
  return result;
}
