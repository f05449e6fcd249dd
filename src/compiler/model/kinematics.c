#include "model/kinematics.h"

#include "algebra/simplify.h"

const char *const axes[3] = {"x", "y", "z"};

struct Vector vector_add(struct Graph *graph, struct Vector a, struct Vector b) {
  for (int i = 0; i < 3; i++) a.along[i] = add(graph, a.along[i], b.along[i]);
  return a;
}

struct Vector vector_subtract(struct Graph *graph, struct Vector a, struct Vector b) {
  for (int i = 0; i < 3; i++) a.along[i] = subtract(graph, a.along[i], b.along[i]);
  return a;
}

struct Vector vector_scale(struct Graph *graph, Node factor, struct Vector a) {
  for (int i = 0; i < 3; i++) a.along[i] = multiply(graph, factor, a.along[i]);
  return a;
}

/* Returns a b - c d. */
static Node difference_of_products(struct Graph *graph, Node a, Node b, Node c, Node d) {
  Node subtrahend = multiply(graph, c, d);
  return subtract(graph, multiply(graph, a, b), subtrahend);
}

struct Vector vector_cross(struct Graph *graph, struct Vector a, struct Vector b) {
  struct Vector product;
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    product.along[i] = difference_of_products(graph, a.along[j], b.along[k], a.along[k], b.along[j]);
  }
  return product;
}

Node vector_dot(struct Graph *graph, struct Vector a, struct Vector b) {
  Node sum = ZERO;
  for (int i = 0; i < 3; i++) sum = add(graph, sum, multiply(graph, a.along[i], b.along[i]));
  return sum;
}

struct Vector matrix_apply(struct Graph *graph, const struct Matrix *matrix, struct Vector a) {
  struct Vector product;
  for (int i = 0; i < 3; i++) product.along[i] = vector_dot(graph, matrix->row[i], a);
  return product;
}

struct Vector matrix_apply_transposed(struct Graph *graph, const struct Matrix *matrix, struct Vector a) {
  struct Vector product = {{ZERO, ZERO, ZERO}};
  for (int i = 0; i < 3; i++) product = vector_add(graph, product, vector_scale(graph, a.along[i], matrix->row[i]));
  return product;
}

struct Matrix matrix_transposed(const struct Matrix *matrix) {
  struct Matrix result;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) result.row[i].along[j] = matrix->row[j].along[i];
  return result;
}

struct Pose pose_of_base(void) {
  return (struct Pose){.rotation.row = {{{ONE, ZERO, ZERO}}, {{ZERO, ONE, ZERO}}, {{ZERO, ZERO, ONE}}}};
}

struct Vector velocity_at(struct Graph *graph, const struct Pose *pose, struct Vector offset, struct Vector rate) {
  struct Vector carried = vector_add(graph, pose->velocity, vector_cross(graph, pose->angular_velocity, offset));
  return vector_add(graph, carried, rate);
}

struct Vector position_at(struct Graph *graph, const struct Pose *pose, struct Vector offset) {
  return vector_add(graph, pose->origin, matrix_apply(graph, &pose->rotation, offset));
}

void pose_translate(struct Graph *graph, struct Pose *pose, struct Vector offset, struct Vector rate) {
  pose->velocity = velocity_at(graph, pose, offset, rate);
  pose->origin = position_at(graph, pose, offset);
}

/*
 * Rotates the frame. turn maps components along the new axes to those along the present ones; spin is the relative
 * angular velocity along the new axes.
 */
static void rotate_axes(struct Graph *graph, struct Pose *pose, const struct Matrix *rotation, struct Vector spin) {
  for (int i = 0; i < 3; i++) pose->rotation.row[i] = matrix_apply_transposed(graph, rotation, pose->rotation.row[i]);
  pose->velocity = matrix_apply_transposed(graph, rotation, pose->velocity);
  pose->angular_velocity = vector_add(graph, matrix_apply_transposed(graph, rotation, pose->angular_velocity), spin);
}

void pose_follow(struct Graph *graph, struct Pose *pose, const struct Pose *step) {
  pose_translate(graph, pose, step->origin, step->velocity);
  rotate_axes(graph, pose, &step->rotation, step->angular_velocity);
}

/* Rodrigues' formula for a unit axis e: R = cos I + sin [e x] + (1 - cos) e e^T. */
void pose_rotate(struct Graph *graph, struct Pose *pose, struct Vector axis, Node angle, Node rate) {
  Node cosine = function(graph, COSINE, angle, ZERO), sine = function(graph, SINE, angle, ZERO);
  Node rest = subtract(graph, ONE, cosine);
  struct Matrix rotation;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      Node product = multiply(graph, axis.along[i], axis.along[j]), *element = &rotation.row[i].along[j];
      Node skew = i == j ? ZERO : multiply(graph, sine, axis.along[3 - i - j]);
      if ((i + 1) % 3 == j) skew = negate(graph, skew);
      *element = add(graph, multiply(graph, rest, product), i == j ? cosine : skew);
    }
  rotate_axes(graph, pose, &rotation, vector_scale(graph, rate, axis));
}

/* The rotation is v -> q v conj(q); the relative angular velocity along the new axes is 2 conj(q) q'. */
void pose_rotate_by_quaternion(struct Graph *graph, struct Pose *pose, const Node q[4], const Node rate[4]) {
  struct Matrix rotation;
  Node square[4];
  struct Vector spin;
  for (int i = 0; i < 4; i++) square[i] = power_number(graph, q[i], 2.0);
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    Node others = add(graph, square[j + 1], square[k + 1]);
    rotation.row[i].along[i] = subtract(graph, add(graph, square[0], square[i + 1]), others);
    Node product = multiply(graph, q[i + 1], q[j + 1]), skew = multiply(graph, q[0], q[k + 1]);
    rotation.row[i].along[j] = scale(graph, 2.0, subtract(graph, product, skew));
    rotation.row[j].along[i] = scale(graph, 2.0, add(graph, product, skew));
    Node forth = difference_of_products(graph, q[0], rate[i + 1], q[i + 1], rate[0]);
    Node around = difference_of_products(graph, q[k + 1], rate[j + 1], q[j + 1], rate[k + 1]);
    spin.along[i] = scale(graph, 2.0, add(graph, forth, around));
  }
  rotate_axes(graph, pose, &rotation, spin);
}
