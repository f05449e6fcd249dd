/*
 * The damping of a servomotor with the damping ratio z and the stiffness k:
 *
 *   damping = 2 z sqrt(k J),   J = 1/(m^T M^-1 m).
 *
 * M is the mass matrix with all joints as placed, and m the derivative of the length of the transmission by the
 * positions, times the gear. So z = 1 is critical if all other joints move freely.
 */
#include <math.h>

#include "base/memory.h"
#include "robots/mjcf/mjcf_inertia.h"
#include "robots/mjcf/mjcf_tree.h"
#include "robots/mjcf/mjcf_values.h"

/* True if an actuator has MuJoCo's mark of a damping ratio: a positive bias by velocity, beside a servomotor's gain. */
static bool has_ratio(const struct Actuator *actuator) {
  return actuator->bias[2] > 0 && actuator->gain[0] == -actuator->bias[1];
}

/* Adds the velocity of a site along a direction, by each velocity that moves it. */
static void add_rates(const struct Velocities *all, size_t link, const double direction[3], double factor,
                      double *sums) {
  for (size_t i = all->last[link]; i > 0; i = all->items[i - 1].previous) {
    double velocity[3];
    mjcf_velocity_at(&all->items[i - 1], all->placements[link].translation, velocity);
    for (int k = 0; k < 3; k++) sums[i - 1] += factor * direction[k] * velocity[k];
  }
}

/* Adds the derivatives of the length of a path. Missing sites are reported elsewhere. */
static void add_path(const struct Robot *robot, const struct Velocities *all, const struct Transmission *path,
                     double gear, double *moments) {
  for (size_t i = 1; i < path->site_count; i++) {
    size_t from = mjcf_link_index(robot, path->site_names[i - 1]), to = mjcf_link_index(robot, path->site_names[i]);
    double direction[3];
    if (from == robot->link_count || to == robot->link_count) continue;
    for (int k = 0; k < 3; k++)
      direction[k] = all->placements[to].translation[k] - all->placements[from].translation[k];
    make_unit(direction);
    add_rates(all, to, direction, gear, moments);
    add_rates(all, from, direction, -gear, moments);
  }
}

/* Returns the derivatives of the length of a transmission by all positions, times the gear. */
static double *moments_of(const struct Mjcf *mjcf, const struct Velocities *all, const struct Actuator *actuator) {
  const struct Robot *robot = mjcf->file.robot;
  const struct Transmission *transmission = &actuator->transmission;
  double *moments = allocate(all->count, sizeof *moments);
  for (size_t i = 0; i < transmission->count; i++) {
    const struct RobotJoint *joint = mjcf_joint(mjcf, transmission->terms[i].joint_name);
    if (joint == NULL || (joint->type != REVOLUTE && joint->type != PRISMATIC)) continue; /* reported elsewhere */
    size_t link = mjcf_link_index(robot, joint->child_name);
    moments[all->last[link] - 1] += actuator->gear * transmission->terms[i].coefficient;
  }
  add_path(robot, all, transmission, actuator->gear, moments);
  return moments;
}

void mjcf_set_dampings(struct Mjcf *mjcf) {
  const struct Robot *robot = mjcf->file.robot;
  struct Inertia inertia = {0};
  for (size_t i = 0; i < robot->actuator_count; i++) {
    struct Actuator *actuator = &robot->actuators[i];
    if (!has_ratio(actuator)) continue;
    if (actuator->gain[0] < 0)
      report_error(mjcf->file.diagnostics, actuator->line,
                   "the third number of biasprm of the actuator '%s' is above 0, a damping ratio, and its gain is "
                   "negative; expected a gain above 0, or the damping itself with its sign",
                   actuator->name);
    if (!mjcf_find_inertia(mjcf, &inertia, actuator->line,
                           format_text("the damping ratio of the actuator '%s'", actuator->name), "the damping kv"))
      return;
    double *moments = moments_of(mjcf, &inertia.all, actuator), moved = mjcf_reflected_inertia(&inertia, moments);
    release(moments);
    actuator->bias[2] *= isfinite(moved) ? -2 * sqrt(fabs(actuator->gain[0]) * moved) : 0;
  }
}
