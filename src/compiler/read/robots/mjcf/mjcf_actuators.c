#include "read/robots/mjcf/mjcf_actuators.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "read/robots/mjcf/mjcf_tendons.h"
#include "read/robots/mjcf/mjcf_tree.h"
#include "read/xml/nodes.h"

/* Reads gain and bias, as MuJoCo defines them for each kind of actuator. */
static void read_law(struct Mjcf *mjcf, xmlNodePtr node, struct Actuator *actuator) {
  static const char *const biases[] = {"none", "affine", NULL};
  actuator->gain = 1;
  if (is_element(node, "position")) {
    actuator->gain = mjcf_number_not_negative(mjcf, node, "kp", 1);
    actuator->bias[1] = -actuator->gain;
    actuator->bias[2] = -mjcf_number_not_negative(mjcf, node, "kv", 0);
  } else if (is_element(node, "velocity")) {
    actuator->gain = mjcf_number_not_negative(mjcf, node, "kv", 1);
    actuator->bias[2] = -actuator->gain;
  } else if (is_element(node, "general")) {
    static const char *const gains[] = {"fixed", NULL}, *const dynamics[] = {"none", NULL};
    double gain[10] = {1}, bias[10] = {0};
    mjcf_word(mjcf, node, "dyntype", dynamics);
    mjcf_word(mjcf, node, "gaintype", gains);
    mjcf_numbers(mjcf, node, "gainprm", 1, 10, gain);
    mjcf_numbers(mjcf, node, "biasprm", 1, 10, bias);
    actuator->gain = gain[0];
    if (mjcf_word(mjcf, node, "biastype", biases) == 1) memcpy(actuator->bias, bias, sizeof actuator->bias);
  }
}

/* Reports ratios to critical damping, which MuJoCo computes from the inertia of the compiled model. */
static void reject_ratio(struct Mjcf *mjcf, xmlNodePtr node, const struct Actuator *actuator) {
  double ratio = is_element(node, "position") ? mjcf_number(mjcf, node, "dampratio", 0) : 0;
  if (ratio != 0)
    report_error(mjcf->file.diagnostics, line_of(node),
                 "dampratio=\"%g\" of <position> is not read; expected kv, the damping itself: -actuator_biasprm[2] of "
                 "MuJoCo's compiled model",
                 ratio);
  if (actuator->bias[2] > 0 && actuator->gain == -actuator->bias[1])
    report_error(mjcf->file.diagnostics, line_of(node),
                 "the third number of biasprm of <%s> is above 0, a ratio of damping, which is not read; expected the "
                 "damping itself with its sign: actuator_biasprm[2] of MuJoCo's compiled model",
                 (const char *)node->name);
}

/* Returns the transmission of a tendon, or of the joint that the element names. */
static struct Transmission transmission_of(struct Mjcf *mjcf, xmlNodePtr node, const struct Tendon *tendon) {
  if (tendon != NULL) return tendon->transmission;
  struct TransmissionTerm *term = allocate(1, sizeof *term);
  *term = (struct TransmissionTerm){.coefficient = 1};
  bool is_at_joint = !has_attribute(node, "tendon");
  if (is_at_joint) term->joint_name = required_attribute(&mjcf->file, node, "joint");
  return (struct Transmission){.terms = term, .count = is_at_joint};
}

/*
 * Limits the control of a servo to a fraction of the range of its joint or tendon. Unknown joints and tendons are
 * reported elsewhere.
 */
static void inherit_range(struct Mjcf *mjcf, xmlNodePtr node, const struct Tendon *tendon, struct Actuator *actuator) {
  double share = mjcf_number_not_negative(mjcf, node, "inheritrange", 0);
  const char *joint_name = attribute(node, "joint");
  if (share == 0 || mjcf_is(mjcf, node, "ctrllimited", "false")) return;
  const struct RobotJoint *joint = joint_name != NULL ? mjcf_joint(mjcf, joint_name) : NULL;
  if (tendon == NULL && joint == NULL) return;
  double lower = tendon != NULL ? tendon->lower : joint->lower, upper = tendon != NULL ? tendon->upper : joint->upper;
  bool is_known = !isnan(lower) && !isnan(upper);
  if (!is_known || !isnan(actuator->control[0])) {
    report_error(mjcf->file.diagnostics, line_of(node), "inheritrange of <position> %s",
                 is_known ? "is beside a ctrlrange; expected one of them"
                          : "is a share of the range of its joint or tendon, which has none; expected ctrlrange");
    return;
  }
  double middle = (lower + upper) / 2, half = share * (upper - lower) / 2;
  actuator->control[0] = middle - half;
  actuator->control[1] = middle + half;
}

/* Reports a spatial tendon if a joint limits actuator forces, as its force on single joints is not computed. */
static void check_limited_joints(struct Mjcf *mjcf, xmlNodePtr node, const struct Actuator *actuator) {
  const struct Robot *robot = mjcf->file.robot;
  for (size_t i = 0; i < robot->joint_count && actuator->transmission.site_count > 0; i++)
    if (!isnan(robot->joints[i]->actuator_limits[0])) {
      report_error(mjcf->file.diagnostics, line_of(node),
                   "the actuator '%s' pulls along a <spatial> tendon, and the joint '%s' has an actuatorfrcrange; "
                   "expected forcerange of the actuators in its place",
                   actuator->name, robot->joints[i]->name);
      return;
    }
}

void mjcf_read_actuator(struct Mjcf *mjcf, xmlNodePtr node) {
  static const char *const rejected[] = {"timeconst", "actdim", "delay", "damping", "armature"};
  struct Robot *robot = mjcf->file.robot;
  if (!is_element(node, "motor") && !is_element(node, "position") && !is_element(node, "velocity") &&
      !is_element(node, "general")) {
    mjcf_report_unknown(mjcf, node, "<motor>, <position>, <velocity> or <general> at a joint or tendon");
    return;
  }
  const char *tendon_name = attribute(node, "tendon");
  const struct Tendon *tendon = tendon_name != NULL ? mjcf_tendon(mjcf, node, tendon_name) : NULL;
  struct Actuator actuator = {
      .name = attribute(node, "name"), .line = line_of(node), .transmission = transmission_of(mjcf, node, tendon)};
  if (actuator.name == NULL) actuator.name = attribute(node, has_attribute(node, "tendon") ? "tendon" : "joint");
  double gear[6] = {1};
  mjcf_numbers(mjcf, node, "gear", 1, 6, gear);
  actuator.gear = gear[0];
  mjcf_check_laws(mjcf, node);
  read_law(mjcf, node, &actuator);
  reject_ratio(mjcf, node, &actuator);
  mjcf_limits(mjcf, node, "ctrlrange", "ctrllimited", actuator.control);
  if (is_element(node, "position")) inherit_range(mjcf, node, tendon, &actuator);
  else mjcf_reject(mjcf, node, "inheritrange");
  mjcf_limits(mjcf, node, "forcerange", "forcelimited", actuator.force);
  check_limited_joints(mjcf, node, &actuator);
  double group = mjcf_number(mjcf, node, "group", 0);
  if (group >= 0 && group < ACTUATOR_GROUPS && mjcf->is_off[(size_t)group]) {
    actuator.gain = 0;
    memset(actuator.bias, 0, sizeof actuator.bias);
    actuator.force[0] = actuator.force[1] = NAN;
  }
  for (size_t i = 0; i < sizeof rejected / sizeof *rejected; i++) mjcf_reject(mjcf, node, rejected[i]);
  robot->actuators = make_room(robot->actuators, robot->actuator_count, sizeof *robot->actuators);
  robot->actuators[robot->actuator_count++] = actuator;
}
