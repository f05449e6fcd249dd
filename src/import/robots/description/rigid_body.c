#include "robots/description/rigid_body.h"

#include <ctype.h>
#include <math.h>
#include <stddef.h>

const struct Placement no_displacement = {.rotation = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};

/*
 * rad: angles this close to multiples of pi/2 are replaced by these, as most files write 1.57079632679 for pi/2. Sines
 * and cosines are then exactly 0 and 1, so that axes are exactly parallel or perpendicular and many terms vanish.
 */
static const double angle_digits = 1e-11;

static double exact_quarter_turns(double angle) {
  double exact = nearbyint(angle / (M_PI / 2)) * (M_PI / 2);
  return fabs(angle - exact) <= angle_digits ? exact : angle;
}

/* Sets sine and cosine, exactly 0 or +-1 at multiples of pi/2. */
static void sine_and_cosine(double angle, double *sine, double *cosine) {
  *sine = sin(angle);
  *cosine = cos(angle);
  if (angle != nearbyint(angle / (M_PI / 2)) * (M_PI / 2)) return;
  *sine = nearbyint(*sine);
  *cosine = nearbyint(*cosine);
}

struct Placement placement_of(const double translation[3], const double angles[3]) {
  double s[3], c[3];
  for (int i = 0; i < 3; i++) sine_and_cosine(exact_quarter_turns(angles[i]), &s[i], &c[i]);
  return (struct Placement){
      .rotation = {{{c[2] * c[1], c[2] * s[1] * s[0] - s[2] * c[0], c[2] * s[1] * c[0] + s[2] * s[0]},
                    {s[2] * c[1], s[2] * s[1] * s[0] + c[2] * c[0], s[2] * s[1] * c[0] - c[2] * s[0]},
                    {-s[1], c[1] * s[0], c[1] * c[0]}}},
      .translation = {translation[0], translation[1], translation[2]}};
}

struct Matrix3 rotation_about(const double axis[3], double angle) {
  double s, c;
  sine_and_cosine(exact_quarter_turns(angle), &s, &c);
  struct Matrix3 rotation;
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    rotation.at[i][i] = c + axis[i] * axis[i] * (1 - c);
    rotation.at[i][j] = axis[i] * axis[j] * (1 - c) - axis[k] * s;
    rotation.at[i][k] = axis[i] * axis[k] * (1 - c) + axis[j] * s;
  }
  return rotation;
}

/*
 * Euler angles of R = Rz(yaw) Ry(pitch) Rx(roll), with 1-based elements:
 *
 *   yaw   = atan2(R21, R11),
 *   pitch = atan2(-R31, c R11 + s R21),
 *   roll  = atan2(s R13 - c R23, c R22 - s R12),   c = cos(yaw), s = sin(yaw).
 *
 * Pitch and roll are computed from Rz(-yaw) R = Ry(pitch) Rx(roll), so that they fit the yaw as rounded. At gimbal
 * lock, pitch = +-pi/2, only the sum or difference of yaw and roll is determined: any yaw is right together with its
 * roll.
 *
 * J. Diebel, Representing Attitude: Euler Angles, Unit Quaternions, and Rotation Vectors, Stanford University, 2006.
 */
void placement_angles(const struct Placement *placement, double angles[3]) {
  const double(*r)[3] = placement->rotation.at;
  double s, c;
  angles[2] = exact_quarter_turns(atan2(r[1][0], r[0][0]));
  sine_and_cosine(angles[2], &s, &c);
  angles[1] = exact_quarter_turns(atan2(-r[2][0], c * r[0][0] + s * r[1][0]));
  angles[0] = exact_quarter_turns(atan2(s * r[0][2] - c * r[1][2], c * r[1][1] - s * r[0][1]));
}

void rotation_apply(const struct Matrix3 *rotation, const double vector[3], double rotated[3]) {
  for (int i = 0; i < 3; i++)
    rotated[i] = rotation->at[i][0] * vector[0] + rotation->at[i][1] * vector[1] + rotation->at[i][2] * vector[2];
}

struct Matrix3 product(const struct Matrix3 *first, const struct Matrix3 *second) {
  struct Matrix3 both;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      both.at[i][j] =
          first->at[i][0] * second->at[0][j] + first->at[i][1] * second->at[1][j] + first->at[i][2] * second->at[2][j];
  return both;
}

struct Matrix3 rotation_of_quaternion(const double q[4]) {
  double length = hypot(hypot(q[1], q[2]), q[3]);
  if (length == 0) return no_displacement.rotation;
  double axis[3] = {q[1] / length, q[2] / length, q[3] / length};
  return rotation_about(axis, 2 * atan2(length, q[0]));
}

struct Matrix3 rotation_of_euler(const char *sequence, const double angles[3]) {
  struct Matrix3 rotation = no_displacement.rotation;
  for (int i = 0; i < 3; i++) {
    double axis[3] = {0};
    axis[tolower((unsigned char)sequence[i]) - 'x'] = 1;
    struct Matrix3 step = rotation_about(axis, angles[i]);
    rotation = isupper((unsigned char)sequence[i]) ? product(&step, &rotation) : product(&rotation, &step);
  }
  return rotation;
}

static struct Matrix3 transposed(const struct Matrix3 *matrix) {
  struct Matrix3 other;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) other.at[i][j] = matrix->at[j][i];
  return other;
}

struct Placement placement_within(const struct Placement *outer, const struct Placement *inner) {
  struct Placement both = {.rotation = product(&outer->rotation, &inner->rotation)};
  rotation_apply(&outer->rotation, inner->translation, both.translation);
  for (int i = 0; i < 3; i++) both.translation[i] += outer->translation[i];
  return both;
}

struct Placement placement_between(const struct Placement *first, const struct Placement *second) {
  struct Placement back = {.rotation = transposed(&first->rotation)};
  rotation_apply(&back.rotation, first->translation, back.translation);
  for (int i = 0; i < 3; i++) back.translation[i] = -back.translation[i];
  return placement_within(&back, second);
}

struct RigidBody body_seen_from(const struct Placement *placement, const struct RigidBody *body) {
  struct RigidBody seen = {.mass = body->mass};
  rotation_apply(&placement->rotation, body->center, seen.center);
  for (int i = 0; i < 3; i++) seen.center[i] += placement->translation[i];
  struct Matrix3 back = transposed(&placement->rotation), half = product(&placement->rotation, &body->tensor);
  seen.tensor = product(&half, &back);
  return seen;
}

struct RigidBody body_scaled(const struct RigidBody *body, double factor) {
  struct RigidBody scaled = *body;
  scaled.mass *= factor;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) scaled.tensor.at[i][j] *= factor;
  return scaled;
}

struct Matrix3 tensor_along(const struct RigidBody *body, const struct Matrix3 *axes) {
  struct Matrix3 back = transposed(axes), half = product(&body->tensor, axes);
  return product(&back, &half);
}

void principal_axes(const struct Matrix3 *symmetric, struct Matrix3 *axes) {
  enum { SWEEPS = 30 }; /* each squares the elements beside the diagonal, relative to those on it */
  const double(*s)[3] = symmetric->at;
  double size = fabs(s[0][0]) + fabs(s[1][1]) + fabs(s[2][2]);
  *axes = no_displacement.rotation;
  for (int i = 0; i < 3 * SWEEPS; i++) {
    int p = (i + 1) % 3, q = (i + 2) % 3;
    struct RigidBody body = {.tensor = *symmetric};
    struct Matrix3 along = tensor_along(&body, axes);
    double beside = along.at[p][q], difference = along.at[p][p] - along.at[q][q];
    if (fabs(beside) <= 1e-15 * size) continue;
    double about[3] = {0};
    about[i % 3] = 1;
    struct Matrix3 step = rotation_about(about, difference != 0 ? atan(2 * beside / difference) / 2 : M_PI / 4);
    *axes = product(axes, &step);
  }
}

/* Returns the tensor about another point, by the parallel axis theorem (Huygens-Steiner). */
static struct Matrix3 tensor_about(const struct RigidBody *body, const double point[3]) {
  struct Matrix3 tensor = body->tensor;
  double d[3], square = 0;
  for (int i = 0; i < 3; i++) {
    d[i] = body->center[i] - point[i];
    square += d[i] * d[i];
  }
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) tensor.at[i][j] += body->mass * ((i == j ? square : 0) - d[i] * d[j]);
  return tensor;
}

struct RigidBody body_joined(const struct RigidBody *first, const struct RigidBody *second) {
  if (!body_has_inertia(first)) return *second;
  if (!body_has_inertia(second)) return *first;
  struct RigidBody both = {.mass = first->mass + second->mass};
  for (int i = 0; i < 3 && both.mass > 0; i++)
    both.center[i] = (first->mass * first->center[i] + second->mass * second->center[i]) / both.mass;
  struct Matrix3 one = tensor_about(first, both.center), other = tensor_about(second, both.center);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) both.tensor.at[i][j] = one.at[i][j] + other.at[i][j];
  return both;
}

static double trace(const struct Matrix3 *matrix) {
  return matrix->at[0][0] + matrix->at[1][1] + matrix->at[2][2];
}

/* Returns 0 if all numbers are finite, else NaN. */
static double defect(const double *numbers, size_t count) {
  double sum = 0;
  for (size_t i = 0; i < count; i++) sum += numbers[i] - numbers[i];
  return sum;
}

static double defect_of(const struct Matrix3 *matrix) {
  return defect(matrix->at[0], 3) + defect(matrix->at[1], 3) + defect(matrix->at[2], 3);
}

bool placement_is_finite(const struct Placement *placement) {
  return defect_of(&placement->rotation) + defect(placement->translation, 3) == 0;
}

bool body_is_finite(const struct RigidBody *body) {
  return defect(&body->mass, 1) + defect(body->center, 3) + defect_of(&body->tensor) == 0;
}

bool body_has_inertia(const struct RigidBody *body) {
  return body->mass > 0 || trace(&body->tensor) > 0;
}
