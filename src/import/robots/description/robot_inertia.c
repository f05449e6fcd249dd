/*
 * The mass matrix M is the sum over all bodies of m Jv^T Jv + Jw^T I Jw, and of the armatures of the joints. Jv is the
 * Jacobian of the centre of mass, and Jw that of the rotation. Its Cholesky factorization M = L L^T costs n^3/6
 * multiplications; files have 100 velocities. Then m^T M^-1 m is the squared length of L^-1 m.
 *
 * R. Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 6.
 */
#include "robots/description/robot_inertia.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

/* Velocities of a free joint. */
enum { MOST_OF_A_JOINT = 6 };

size_t robot_link_index(const struct Robot *robot, const char *name) {
  size_t i = 0;
  while (i < robot->link_count && strcmp(robot->links[i]->name, name) != 0) i++;
  return i;
}

struct Placement placement_at_start(const struct RobotJoint *joint) {
  struct Placement motion = no_displacement;
  const double *start = joint->start.position;
  if (joint->type == REVOLUTE || joint->type == CONTINUOUS) motion.rotation = rotation_about(joint->axis, start[0]);
  for (int i = 0; i < 3 && joint->type == PRISMATIC; i++) motion.translation[i] = joint->axis[i] * start[0];
  if (joint->type == PRESCRIBED) motion = placement_of(start, &start[3]);
  if (joint->type == FLOATING) {
    memcpy(motion.translation, start, sizeof motion.translation);
    motion.rotation = rotation_of_quaternion(&start[3]);
  }
  return placement_within(&joint->origin, &motion);
}

static void add_velocity(struct Velocities *all, const struct RobotJoint *joint, size_t link, bool rotates,
                         const double axis[3]) {
  struct Velocity *velocity = &all->items[all->count++];
  *velocity = (struct Velocity){.rotates = rotates, .armature = joint->armature, .previous = all->last[link]};
  memcpy(velocity->axis, axis, sizeof velocity->axis);
  memcpy(velocity->point, all->placements[link].translation, sizeof velocity->point);
  all->last[link] = all->count;
}

/* Adds the velocities of a joint: along or about its axis, or about the axes of the body, after those of the world. */
static void add_velocities(struct Velocities *all, const struct RobotJoint *joint, size_t link) {
  const struct Matrix3 *rotation = &all->placements[link].rotation;
  double axis[3];
  if (joint->type == REVOLUTE || joint->type == PRISMATIC) {
    rotation_apply(rotation, joint->axis, axis);
    add_velocity(all, joint, link, joint->type == REVOLUTE, axis);
  }
  for (int i = 0; i < 3 && joint->type == FLOATING; i++)
    add_velocity(all, joint, link, false, no_displacement.rotation.at[i]);
  for (int i = 0; i < 3 && (joint->type == FLOATING || joint->type == BALL); i++) {
    rotation_apply(rotation, no_displacement.rotation.at[i], axis);
    add_velocity(all, joint, link, true, axis);
  }
}

/* Finds placements and velocities. Links and joints are in an order in which parents come first. */
static struct Velocities velocities_of(const struct Robot *robot) {
  struct Velocities all = {.items = allocate(MOST_OF_A_JOINT * robot->joint_count + 1, sizeof *all.items),
                           .placements = allocate(robot->link_count, sizeof *all.placements),
                           .last = allocate(robot->link_count, sizeof *all.last)};
  all.placements[0] = no_displacement;
  for (size_t i = 0; i < robot->joint_count; i++) {
    const struct RobotJoint *joint = robot->joints[i];
    size_t parent = robot_link_index(robot, joint->parent_name), child = robot_link_index(robot, joint->child_name);
    if (parent == robot->link_count || child == robot->link_count) continue; /* reported elsewhere */
    struct Placement placement = placement_at_start(joint);
    all.placements[child] = placement_within(&all.placements[parent], &placement);
    all.last[child] = all.last[parent];
    add_velocities(&all, joint, child);
  }
  return all;
}

/* The velocity is axis x (point - its own) for a rotation, else the axis. */
void robot_velocity_at(const struct Velocity *velocity, const double point[3], double result[3]) {
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    result[i] = velocity->rotates ? velocity->axis[j] * (point[k] - velocity->point[k]) -
                                        velocity->axis[k] * (point[j] - velocity->point[j])
                                  : velocity->axis[i];
  }
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Adds a body to the lower triangle of the mass matrix. body: in the world. */
static void add_body(const struct Velocities *all, const struct RigidBody *body, size_t last, double *mass) {
  for (size_t i = last; i > 0; i = all->items[i - 1].previous)
    for (size_t j = i; j > 0; j = all->items[j - 1].previous) {
      const struct Velocity *one = &all->items[i - 1], *other = &all->items[j - 1];
      double v[3], w[3], spin[3];
      robot_velocity_at(one, body->center, v);
      robot_velocity_at(other, body->center, w);
      rotation_apply(&body->tensor, other->axis, spin);
      mass[(i - 1) * all->count + j - 1] +=
          body->mass * dot(v, w) + (one->rotates && other->rotates ? dot(one->axis, spin) : 0);
    }
}

/* Returns the lower triangle of the mass matrix. */
static double *mass_matrix(const struct Robot *robot, const struct Velocities *all) {
  double *mass = allocate(all->count * all->count, sizeof *mass);
  for (size_t i = 0; i < robot->link_count; i++) {
    struct RigidBody body = body_seen_from(&all->placements[i], &robot->links[i]->body);
    add_body(all, &body, all->last[i], mass);
  }
  for (size_t i = 0; i < all->count; i++) mass[i * all->count + i] += all->items[i].armature;
  return mass;
}

/* Replaces the lower triangle of a matrix by its Cholesky factor. */
static void factorize(double *matrix, size_t n) {
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j <= i; j++) {
      double sum = matrix[i * n + j];
      for (size_t k = 0; k < j; k++) sum -= matrix[i * n + k] * matrix[j * n + k];
      matrix[i * n + j] = i == j ? sqrt(sum) : sum / matrix[j * n + j];
    }
}

double robot_reflected_inertia(const struct Inertia *inertia, const double *moments) {
  size_t n = inertia->all.count;
  double *x = allocate(n, sizeof *x), sum = 0;
  for (size_t i = 0; i < n; i++) {
    x[i] = moments[i];
    for (size_t k = 0; k < i; k++) x[i] -= inertia->factor[i * n + k] * x[k];
    x[i] /= inertia->factor[i * n + i];
    sum += x[i] * x[i];
  }
  release(x);
  return 1 / sum;
}

bool robot_find_inertia(const struct Robot *robot, struct Inertia *inertia, struct Diagnostics *diagnostics, long line,
                        const char *what, const char *remedy) {
  for (size_t i = 0; i < robot->tendon_count; i++) {
    if (robot->tendons[i].armature == 0) continue;
    report_error(diagnostics, line, "%s is beside the armature of the tendon '%s'; expected %s in its place", what,
                 robot->tendons[i].name, remedy);
    return false;
  }
  if (inertia->factor != NULL) return true;
  inertia->all = velocities_of(robot);
  inertia->factor = mass_matrix(robot, &inertia->all);
  factorize(inertia->factor, inertia->all.count);
  return true;
}
