#include "robots/mjcf/mjcf_sections.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "robots/mjcf/values/mjcf_tree.h"
#include "xml/nodes.h"

/* Sets the dynamics of a filter, or none if the time constant is 0. */
static void set_filter(struct Actuator *actuator, double time_constant) {
  actuator->dynamics = time_constant > 0 ? FILTER : WITHOUT_STATE;
  actuator->time_constant = time_constant;
}

static void read_motor(struct Mjcf *mjcf, xmlNodePtr node, struct Actuator *actuator) {
  (void)mjcf, (void)node;
  actuator->gain[0] = 1;
}

/* Reads a servomotor. A positive bias by velocity is a damping ratio until mjcf_set_springs() replaces it. */
static void read_position(struct Mjcf *mjcf, xmlNodePtr node, struct Actuator *actuator) {
  actuator->gain[0] = mjcf_number_not_negative(mjcf, node, "kp", 1);
  actuator->bias[1] = -actuator->gain[0];
  double damping = mjcf_number_not_negative(mjcf, node, "kv", 0),
         ratio = mjcf_number_not_negative(mjcf, node, "dampratio", 0);
  actuator->bias[2] = mjcf_prevails(mjcf, node, "dampratio", "kv") ? ratio : -damping;
  set_filter(actuator, mjcf_number_not_negative(mjcf, node, "timeconst", 0));
}

static void read_integrated_velocity(struct Mjcf *mjcf, xmlNodePtr node, struct Actuator *actuator) {
  read_position(mjcf, node, actuator);
  actuator->dynamics = INTEGRATOR;
}

static void read_velocity(struct Mjcf *mjcf, xmlNodePtr node, struct Actuator *actuator) {
  actuator->gain[0] = mjcf_number_not_negative(mjcf, node, "kv", 1);
  actuator->bias[2] = -actuator->gain[0];
}

static void read_damper(struct Mjcf *mjcf, xmlNodePtr node, struct Actuator *actuator) {
  actuator->gain[2] = -mjcf_number_not_negative(mjcf, node, "kv", 1);
}

static void read_cylinder(struct Mjcf *mjcf, xmlNodePtr node, struct Actuator *actuator) {
  double diameter = mjcf_number_not_negative(mjcf, node, "diameter", 0);
  actuator->gain[0] = mjcf_number_not_negative(mjcf, node, "area", 1);
  if (diameter > 0) actuator->gain[0] = M_PI / 4 * diameter * diameter;
  mjcf_numbers(mjcf, node, "bias", 3, 3, actuator->bias);
  set_filter(actuator, mjcf_number_not_negative(mjcf, node, "timeconst", 1));
}

static void read_general(struct Mjcf *mjcf, xmlNodePtr node, struct Actuator *actuator) {
  static const char *const biases[] = {"none", "affine", NULL}, *const gains[] = {"fixed", "affine", NULL};
  static const char *const dynamics[] = {"none", "integrator", "filter", "filterexact", NULL};
  double gain[10] = {1}, bias[10] = {0}, constants[10] = {1};
  mjcf_numbers(mjcf, node, "gainprm", 1, 10, gain);
  mjcf_numbers(mjcf, node, "biasprm", 1, 10, bias);
  mjcf_numbers(mjcf, node, "dynprm", 1, 10, constants);
  memcpy(actuator->gain, gain, (mjcf_word(mjcf, node, "gaintype", gains) == 1 ? 3 : 1) * sizeof *gain);
  if (mjcf_word(mjcf, node, "biastype", biases) == 1) memcpy(actuator->bias, bias, sizeof actuator->bias);
  size_t kind = mjcf_word(mjcf, node, "dyntype", dynamics);
  if (kind == 1) actuator->dynamics = INTEGRATOR;
  if (kind > 1 && constants[0] > 0) set_filter(actuator, constants[0]);
  else if (kind > 1)
    mjcf_error(mjcf, node, "the time constant %g of dynprm of <general> is not above 0; expected seconds",
               constants[0]);
}

/* The kinds of actuators, with the gain, bias and dynamics that MuJoCo defines for each. */
static const struct {
  const char *name;
  void (*read)(struct Mjcf *mjcf, xmlNodePtr node, struct Actuator *actuator);
} kinds[] = {
    {"motor", read_motor},       {"position", read_position}, {"velocity", read_velocity},
    {"general", read_general},   {"damper", read_damper},     {"intvelocity", read_integrated_velocity},
    {"cylinder", read_cylinder},
};

enum { KINDS = sizeof kinds / sizeof *kinds };

static size_t kind_of(xmlNodePtr node) {
  size_t kind = 0;
  while (kind < KINDS && !is_element(node, kinds[kind].name)) kind++;
  return kind;
}

/* Returns the attribute that names the joint of an actuator. */
static const char *joint_attribute(xmlNodePtr node) {
  return has_attribute(node, "jointinparent") ? "jointinparent" : "joint";
}

/*
 * Returns the wrench of an actuator at a site, or at a free or ball joint; NULL for others. As MuJoCo defines it, the
 * force is along the axes of the site or of the world. The torque is along those of the site or body, or with
 * jointinparent along those that the body has at the joint's zero.
 */
static struct Wrench *wrench_of(struct Mjcf *mjcf, xmlNodePtr node, const double gear[6]) {
  const char *name = attribute(node, joint_attribute(node));
  const struct RobotJoint *joint = name != NULL ? mjcf_joint(mjcf, name) : NULL;
  bool is_free = joint != NULL && joint->type == FLOATING, is_ball = joint != NULL && joint->type == BALL;
  bool is_at_site = name == NULL && has_attribute(node, "site"), is_in_parent = has_attribute(node, "jointinparent");
  if (!is_at_site && !is_free && !is_ball) return NULL;
  struct Wrench *wrench = allocate(1, sizeof *wrench);
  char *link = is_at_site ? mjcf_site(mjcf, attribute(node, "site")) : joint->child_name;
  wrench->names[WRENCH_LINK] = link;
  if (is_at_site && mjcf_placement_of(mjcf, link) == NULL)
    mjcf_error(mjcf, node, "there is no site '%s' for a <%s>; expected an existing name", link,
               (const char *)node->name);
  if (is_at_site) wrench->names[FORCE_AXES] = link;
  if (!is_in_parent) wrench->names[TORQUE_AXES] = link;
  memcpy(wrench->torque, is_ball ? gear : gear + 3, sizeof wrench->torque);
  if (!is_ball) memcpy(wrench->force, gear, sizeof wrench->force);
  if (!is_ball) return wrench;
  wrench->names[WRENCH_SUPPORT] = joint->parent_name;
  if (!is_in_parent) return wrench;
  wrench->names[TORQUE_AXES] = joint->parent_name;
  rotation_apply(&joint->origin.rotation, gear, wrench->torque);
  return wrench;
}

/* Reports an actuator whose force depends on a position or velocity, which a wrench does not have. */
static void check_wrench(struct Mjcf *mjcf, xmlNodePtr node, const struct Actuator *actuator) {
  const double *bias = actuator->bias, *gain = actuator->gain;
  if (bias[1] == 0 && bias[2] == 0 && gain[1] == 0 && gain[2] == 0) return;
  mjcf_error(mjcf, node,
             "<%s> at a site, free joint or ball joint is not read, as its force depends on the motion; expected a "
             "<motor> there",
             (const char *)node->name);
}

/* Returns the transmission of a tendon, or of the joint that the element names. */
static struct Transmission transmission_of(struct Mjcf *mjcf, xmlNodePtr node, const struct Tendon *tendon) {
  if (tendon != NULL) return tendon->transmission;
  struct TransmissionTerm *term = allocate(1, sizeof *term);
  *term = (struct TransmissionTerm){.coefficient = 1};
  bool is_at_joint = !has_attribute(node, "tendon");
  if (is_at_joint && has_attribute(node, "cranksite") && !has_attribute(node, joint_attribute(node)))
    mjcf_error(mjcf, node, "<%s> at a crank is not read; expected it at a joint, tendon or site",
               (const char *)node->name);
  else if (is_at_joint) term->joint_name = required_attribute(&mjcf->file, node, joint_attribute(node));
  return (struct Transmission){.terms = term, .count = is_at_joint};
}

/*
 * Limits the control ("ctrl") or activation ("act") of a servo to a fraction of the range of its joint or tendon.
 * Unknown joints and tendons are reported elsewhere.
 */
static void inherit_range(struct Mjcf *mjcf, xmlNodePtr node, const struct Tendon *tendon, const char *prefix,
                          double limits[2]) {
  const char *range = format_text("%srange", prefix);
  double share = mjcf_number_not_negative(mjcf, node, "inheritrange", 0);
  const char *joint_name = attribute(node, joint_attribute(node));
  if (share == 0 || !mjcf_prevails(mjcf, node, "inheritrange", range) ||
      mjcf_is(mjcf, node, format_text("%slimited", prefix), "false"))
    return;
  const struct RobotJoint *joint = joint_name != NULL ? mjcf_joint(mjcf, joint_name) : NULL;
  if (tendon == NULL && joint == NULL) return;
  double lower = tendon != NULL ? tendon->lower : joint->lower, upper = tendon != NULL ? tendon->upper : joint->upper;
  if (isnan(lower)) {
    mjcf_error(mjcf, node,
               "inheritrange of <%s> is a share of the range of its joint or tendon, which has none; expected %s",
               (const char *)node->name, range);
    return;
  }
  double middle = (lower + upper) / 2, half = share * (upper - lower) / 2;
  limits[0] = middle - half;
  limits[1] = middle + half;
}

/* Reports a spatial tendon or wrench if a joint limits actuator forces, as its force on single joints is not computed. */
static void check_limited_joints(struct Mjcf *mjcf, xmlNodePtr node, const struct Actuator *actuator) {
  const struct Robot *robot = mjcf->file.robot;
  bool acts_in_space = actuator->wrench != NULL || actuator->transmission.site_count > 0;
  for (size_t i = 0; i < robot->joint_count && acts_in_space; i++)
    if (!isnan(robot->joints[i]->actuator_limits[0])) {
      mjcf_error(
          mjcf, node,
          "the actuator '%s' acts at a site or along a <spatial> tendon, and the joint '%s' has an actuatorfrcrange; "
          "expected forcerange of the actuators in its place",
          actuator->name, robot->joints[i]->name);
      return;
    }
}

static bool is_taken(const struct Robot *robot, const char *name) {
  for (size_t i = 0; i < robot->actuator_count; i++)
    if (robot->actuators[i].name != NULL && strcmp(robot->actuators[i].name, name) == 0) return true;
  return false;
}

/* Returns the name of an actuator: its own, or that of its joint, tendon or site, with a number behind further ones. */
static char *name_actuator(const struct Robot *robot, xmlNodePtr node) {
  static const char *const names[] = {"name", "tendon", "joint", "jointinparent", "site", "body"};
  char *first = NULL;
  for (size_t i = 0; i < sizeof names / sizeof *names && first == NULL; i++) first = attribute(node, names[i]);
  char *name = first;
  if (first == NULL || has_attribute(node, "name")) return first;
  for (size_t number = 2; is_taken(robot, name); number++) name = format_text("%s_%zu", first, number);
  return name;
}

/* True if the actuator is adhesion, which presses the shapes of a body to those that they touch. */
static bool is_adhesion(xmlNodePtr node) {
  return is_element(node, "adhesion") || (is_element(node, "general") && has_attribute(node, "body"));
}

/* Reads an adhesion as a force of size 0 where no shapes touch, so that its input remains. Reports it where they do. */
static void read_adhesion(struct Mjcf *mjcf, xmlNodePtr node, struct Actuator *actuator) {
  const struct RobotOptions *options = mjcf->file.options;
  actuator->wrench = allocate(1, sizeof *actuator->wrench);
  actuator->wrench->names[WRENCH_LINK] = required_attribute(&mjcf->file, node, "body");
  if (options->has_ground || options->has_self)
    mjcf_report_unknown(mjcf, node, "a <force> on the body in a <system> that includes the robot");
  else
    report_warning(mjcf->file.diagnostics, actuator->line,
                   "the adhesion '%s' has no effect, as the shapes of the body '%s' touch nothing; remove it",
                   actuator->name, actuator->wrench->names[WRENCH_LINK]);
}

/* Reports attributes that are not read. */
static void reject_attributes(struct Mjcf *mjcf, xmlNodePtr node) {
  mjcf_reject(mjcf, node, "delay damping armature");
  if (mjcf_number(mjcf, node, "actdim", 1) > 1)
    mjcf_error(mjcf, node, "actdim of <%s> is above 1; expected an actuator with one activation",
               (const char *)node->name);
  if (mjcf_text(mjcf, node, "refsite") != NULL)
    mjcf_error(mjcf, node,
               "refsite=\"%.60s\" of <%s> is not read; expected a <spatial> tendon from site to site, or a <joint>",
               mjcf_text(mjcf, node, "refsite"), (const char *)node->name);
}

/* Reads an actuator at a joint, tendon or site. */
static void read_force(struct Mjcf *mjcf, xmlNodePtr node, size_t kind, struct Actuator *actuator) {
  const char *tendon_name = attribute(node, "tendon");
  const struct Tendon *tendon = tendon_name != NULL ? mjcf_tendon(mjcf, node, tendon_name) : NULL;
  double gear[6] = {1};
  mjcf_numbers(mjcf, node, "gear", 1, 6, gear);
  actuator->gear = gear[0];
  actuator->wrench = wrench_of(mjcf, node, gear);
  if (actuator->wrench == NULL) actuator->transmission = transmission_of(mjcf, node, tendon);
  mjcf_check_laws(mjcf, node);
  kinds[kind].read(mjcf, node, actuator);
  if (actuator->wrench != NULL) check_wrench(mjcf, node, actuator);
  if (is_element(node, "position")) inherit_range(mjcf, node, tendon, "ctrl", actuator->control);
  else if (is_element(node, "intvelocity")) inherit_range(mjcf, node, tendon, "act", actuator->activation);
  else mjcf_reject(mjcf, node, "inheritrange");
  check_limited_joints(mjcf, node, actuator);
  double group = mjcf_number(mjcf, node, "group", 0);
  if (group >= 0 && group < ACTUATOR_GROUPS && mjcf->is_off[(size_t)group]) mjcf_switch_off(actuator);
  reject_attributes(mjcf, node);
}

void mjcf_read_actuator(struct Mjcf *mjcf, xmlNodePtr node) {
  struct Robot *robot = mjcf->file.robot;
  struct Actuator actuator = {.name = name_actuator(robot, node), .line = line_of(node)};
  size_t kind = kind_of(node);
  if (kind == KINDS && !is_adhesion(node)) {
    mjcf_report_unknown(mjcf, node, "<motor>, <position>, <velocity> or <general> at a joint, tendon or site");
    return;
  }
  mjcf_limits(mjcf, node, "ctrlrange", "ctrllimited", actuator.control);
  mjcf_limits(mjcf, node, "actrange", "actlimited", actuator.activation);
  mjcf_limits(mjcf, node, "forcerange", "forcelimited", actuator.force);
  if (is_adhesion(node)) read_adhesion(mjcf, node, &actuator);
  else read_force(mjcf, node, kind, &actuator);
  APPEND(robot->actuators, robot->actuator_count, actuator);
}
