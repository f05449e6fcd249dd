/* Poses and rigid bodies as numbers. Bodies that are fixed to each other are merged. */
#pragma once

#include <stdbool.h>

/* A 3 x 3 matrix by rows. */
struct Matrix3 {
  double at[3][3];
};

/* Pose of a frame in an outer frame: a point p of the inner frame is rotation*p + translation in the outer one. m. */
struct Placement {
  struct Matrix3 rotation;
  double translation[3];
};

/* Inertia in some frame: mass in kg, centre in m, tensor in kg.m2 about the centre of mass, along the frame's axes. */
struct RigidBody {
  double mass, center[3];
  struct Matrix3 tensor;
};

extern const struct Placement no_displacement;

/*
 * Returns the pose of a translation and of rotations about the fixed axes x, y, z, in this order: Rz(yaw) Ry(pitch)
 * Rx(roll). angles: roll, pitch, yaw in rad.
 */
struct Placement placement_of(const double translation[3], const double angles[3]);

/* Returns the rotation by an angle about a unit vector (Rodrigues' formula). */
struct Matrix3 rotation_about(const double axis[3], double angle);

/* Returns the rotation by a quaternion of any nonzero norm, the real part first. */
struct Matrix3 rotation_of_quaternion(const double q[4]);

/*
 * Returns the rotation by Euler angles in a sequence such as "xyz". Capital letters rotate about the axes of the outer
 * frame (extrinsic), small ones about the rotated axes (intrinsic).
 */
struct Matrix3 rotation_of_euler(const char *sequence, const double angles[3]);

/* Returns the matrix product. */
struct Matrix3 product(const struct Matrix3 *first, const struct Matrix3 *second);

/* Sets a vector to the product of a rotation and another vector. */
void rotation_apply(const struct Matrix3 *rotation, const double vector[3], double rotated[3]);

/* Sets the roll, pitch and yaw of a rotation, see rigid_body.c. */
void placement_angles(const struct Placement *placement, double angles[3]);

/* Returns the composition of two poses: that of inner in the frame that outer is placed in. */
struct Placement placement_within(const struct Placement *outer, const struct Placement *inner);

/* Returns the pose of the second frame in the first one, both given in a third one. */
struct Placement placement_between(const struct Placement *first, const struct Placement *second);

/* Returns the body in the outer frame of a pose, given the body in the inner one. */
struct RigidBody body_seen_from(const struct Placement *placement, const struct RigidBody *body);

/* Returns the body with its mass and tensor multiplied by a factor. */
struct RigidBody body_scaled(const struct RigidBody *body, double factor);

/* Returns two bodies, given in the same frame, merged to one. */
struct RigidBody body_joined(const struct RigidBody *first, const struct RigidBody *second);

/* Sets the columns of `axes` to the principal axes of a symmetric matrix, by Jacobi's rotations. */
void principal_axes(const struct Matrix3 *symmetric, struct Matrix3 *axes);

/* Returns the tensor of the body along other axes, the columns of a rotation. */
struct Matrix3 tensor_along(const struct RigidBody *body, const struct Matrix3 *axes);

/* True if the body has a mass or a moment of inertia. */
bool body_has_inertia(const struct RigidBody *body);

/* True if all numbers are finite. */
bool placement_is_finite(const struct Placement *placement);
bool body_is_finite(const struct RigidBody *body);
