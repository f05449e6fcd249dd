/*
 * Springs and dampers that a file gives by the oscillator that they make with the inertia J. springdamper = "T z" of a
 * joint is its time constant and damping ratio:
 *
 *   stiffness = J/(T z)^2,   damping = 2 J/T.
 *
 * A servomotor with the damping ratio z and the stiffness k has the damping 2 z sqrt(k J). Here J = 1/(m^T M^-1 m). M is
 * the mass matrix with all joints as placed, and m the derivative of the position, or of the length of the transmission
 * times the gear. So z = 1 is critical if all other joints move freely.
 */
#include "robots/description/robot_inertia.h"

#include <math.h>

#include "base/memory.h"
#include "robots/mjcf/values/mjcf_tree.h"
#include "robots/mjcf/mjcf_sections.h"
#include "xml/nodes.h"

void mjcf_note_spring(struct Mjcf *mjcf, xmlNodePtr node, struct RobotJoint *joint) {
  double values[2] = {0};
  if (mjcf_numbers(mjcf, node, "springdamper", 2, 2, values) == 0 || (values[0] == 0 && values[1] == 0)) return;
  if (values[0] <= 0 || values[1] <= 0)
    mjcf_error(mjcf, node,
               "springdamper=\"%g %g\" of <joint> is not valid; expected a time constant and a damping ratio above 0",
               values[0], values[1]);
  joint->time_constant = values[0];
  joint->damping_ratio = values[1];
}

/* Sets stiffness and damping of the joints with a springdamper. */
static void set_springs(const struct Mjcf *mjcf, struct Inertia *inertia) {
  const struct Robot *robot = mjcf->file.robot;
  for (size_t i = 0; i < robot->joint_count; i++) {
    struct RobotJoint *joint = robot->joints[i];
    if (joint->time_constant == 0) continue;
    if (!robot_find_inertia(robot, inertia, mjcf->file.diagnostics, joint->line,
                            format_text("springdamper of the joint '%s'", joint->name), "stiffness and damping"))
      return;
    double *moments = allocate(inertia->all.count, sizeof *moments);
    moments[inertia->all.last[robot_link_index(robot, joint->child_name)] - 1] = 1;
    double moved = robot_reflected_inertia(inertia, moments), product = joint->time_constant * joint->damping_ratio;
    release(moments);
    if (!isfinite(moved)) continue; /* a joint without inertia is reported elsewhere */
    joint->stiffness = moved / (product * product);
    joint->damping = 2 * moved / joint->time_constant;
  }
}

/* True if an actuator has MuJoCo's mark of a damping ratio: a positive bias by velocity, beside a servomotor's gain. */
static bool has_ratio(const struct Actuator *actuator) {
  return actuator->bias[2] > 0 && actuator->gain[0] == -actuator->bias[1];
}

/* Adds the velocity of a site along a direction, by each velocity that moves it. */
static void add_rates(const struct Velocities *all, size_t link, const double direction[3], double factor,
                      double *sums) {
  for (size_t i = all->last[link]; i > 0; i = all->items[i - 1].previous) {
    double velocity[3];
    robot_velocity_at(&all->items[i - 1], all->placements[link].translation, velocity);
    for (int k = 0; k < 3; k++) sums[i - 1] += factor * direction[k] * velocity[k];
  }
}

/* Adds the derivatives of the length of a path. Missing sites are reported elsewhere. */
static void add_path(const struct Robot *robot, const struct Velocities *all, const struct Transmission *path,
                     double gear, double *moments) {
  for (size_t i = 1; i < path->site_count; i++) {
    size_t from = robot_link_index(robot, path->site_names[i - 1]), to = robot_link_index(robot, path->site_names[i]);
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
    size_t link = robot_link_index(robot, joint->child_name);
    moments[all->last[link] - 1] += actuator->gear * transmission->terms[i].coefficient;
  }
  add_path(robot, all, transmission, actuator->gear, moments);
  return moments;
}

/* Replaces the damping ratios of actuators by their dampings. */
static void set_dampings(const struct Mjcf *mjcf, struct Inertia *inertia) {
  const struct Robot *robot = mjcf->file.robot;
  for (size_t i = 0; i < robot->actuator_count; i++) {
    struct Actuator *actuator = &robot->actuators[i];
    if (!has_ratio(actuator)) continue;
    if (actuator->gain[0] < 0)
      report_error(mjcf->file.diagnostics, actuator->line,
                   "the third number of biasprm of the actuator '%s' is above 0, a damping ratio, and its gain is "
                   "negative; expected a gain above 0, or the damping itself with its sign",
                   actuator->name);
    if (!robot_find_inertia(robot, inertia, mjcf->file.diagnostics, actuator->line,
                            format_text("the damping ratio of the actuator '%s'", actuator->name), "the damping kv"))
      return;
    double *moments = moments_of(mjcf, &inertia->all, actuator), moved = robot_reflected_inertia(inertia, moments);
    release(moments);
    actuator->bias[2] *= isfinite(moved) ? -2 * sqrt(fabs(actuator->gain[0]) * moved) : 0;
  }
}

void mjcf_set_springs(struct Mjcf *mjcf) {
  struct Inertia inertia = {0};
  set_springs(mjcf, &inertia);
  set_dampings(mjcf, &inertia);
}
