/*
 * springdamper = "T z" of a joint, the time constant and damping ratio of an oscillator with the inertia J:
 *
 *   stiffness = J/(T z)^2,   damping = 2 J/T,   J = 1/(M^-1)_jj.
 *
 * M is the mass matrix with all joints as placed. So J is the inertia that the joint moves while all others move freely.
 */
#include "robots/mjcf/mjcf_inertia.h"

#include <math.h>

#include "base/memory.h"
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

void mjcf_set_springs(struct Mjcf *mjcf) {
  const struct Robot *robot = mjcf->file.robot;
  struct Inertia inertia = {0};
  for (size_t i = 0; i < robot->joint_count; i++) {
    struct RobotJoint *joint = robot->joints[i];
    if (joint->time_constant == 0) continue;
    if (!mjcf_find_inertia(mjcf, &inertia, joint->line, format_text("springdamper of the joint '%s'", joint->name),
                           "stiffness and damping"))
      return;
    double *moments = allocate(inertia.all.count, sizeof *moments);
    moments[inertia.all.last[mjcf_link_index(robot, joint->child_name)] - 1] = 1;
    double moved = mjcf_reflected_inertia(&inertia, moments), product = joint->time_constant * joint->damping_ratio;
    release(moments);
    if (!isfinite(moved)) continue; /* a joint without inertia is reported elsewhere */
    joint->stiffness = moved / (product * product);
    joint->damping = 2 * moved / joint->time_constant;
  }
}
