/* Rigid bodies and the places of frames in numbers: what is fixed together becomes one body. */
#pragma once

#include <stdbool.h>

struct Matrix3 {
  double at[3][3];
};

/* Of a frame in another: a point p there is rotation*p + translation here. */
struct Placement {
  struct Matrix3 rotation;
  double translation[3];
};

/* In some frame: the tensor is about the centre of mass, along the frame's axes. */
struct RigidBody {
  double mass, center[3];
  struct Matrix3 tensor;
};

extern const struct Placement no_displacement;

/* By angles about the fixed axes x, y, z in this order (roll, pitch, yaw): Rz(yaw) Ry(pitch) Rx(roll). */
struct Placement placement_of(const double translation[3], const double angles[3]);

/* By an angle about an axis of length 1. */
struct Matrix3 rotation_about(const double axis[3], double angle);

/* Of two matrices. */
struct Matrix3 product(const struct Matrix3 *first, const struct Matrix3 *second);

/* The angles of placement_of(). */
void placement_angles(const struct Placement *placement, double angles[3]);

/* Where a frame is that is placed in another one, which is itself placed in a third. */
struct Placement placement_within(const struct Placement *outer, const struct Placement *inner);

/* Where the second frame is in the first, both of which are placed in a third. */
struct Placement placement_between(const struct Placement *first, const struct Placement *second);

/* The same body as seen from the frame in which its own is placed. */
struct RigidBody body_seen_from(const struct Placement *placement, const struct RigidBody *body);

/* The same with its mass, and all that goes with it, multiplied. */
struct RigidBody body_scaled(const struct RigidBody *body, double factor);

/* Both as one. */
struct RigidBody body_joined(const struct RigidBody *first, const struct RigidBody *second);

/* Whether it resists any motion: has a mass or a moment of inertia. */
bool body_has_inertia(const struct RigidBody *body);

/* Whether all numbers of them are finite. */
bool placement_is_finite(const struct Placement *placement);
bool body_is_finite(const struct RigidBody *body);

/*
 * Whether no principal moment of inertia is negative, or larger than the other two together, as they are for any mass that is spread in
 * space; a hundredth of their sum is granted for the digits of files.
 */
bool tensor_is_of_a_body(const struct Matrix3 *tensor);
