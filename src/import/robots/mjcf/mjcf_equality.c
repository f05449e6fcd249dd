#include "robots/mjcf/mjcf_sections.h"

#include <string.h>

#include "base/memory.h"
#include "robots/mjcf/values/mjcf_tree.h"
#include "xml/nodes.h"

/* Returns the part of a coupling that is one joint. */
static struct CoupledPart part_of_joint(struct RobotJoint *joint) {
  struct TransmissionTerm *term = allocate(1, sizeof *term);
  *term = (struct TransmissionTerm){.joint_name = joint->name, .coefficient = 1};
  return (struct CoupledPart){
      .name = joint->name, .transmission = {.terms = term, .count = 1}, .start = joint->start.position[0]};
}

/* Adds a coupling. Without a second part, only the constant of its polynomial remains. */
static void add_coupling(struct Mjcf *mjcf, struct Coupling coupling) {
  struct Robot *robot = mjcf->file.robot;
  for (int power = 1; power < COUPLING_POWERS && coupling.parts[1].name == NULL; power++)
    coupling.coefficient[power] = 0;
  APPEND(robot->couplings, robot->coupling_count, coupling);
}

/* Returns the joint that an attribute names; NULL after reporting that there is none. */
static struct RobotJoint *find_joint(struct Mjcf *mjcf, xmlNodePtr node, const char *attribute_name) {
  const char *name = required_attribute(&mjcf->file, node, attribute_name);
  struct RobotJoint *joint = mjcf_joint(mjcf, name);
  if (joint == NULL && *name != '\0')
    mjcf_error(mjcf, node, "there is no joint '%s' for an <equality>; expected an existing name", name);
  return joint;
}

/* Makes the first joint mimic the second one. Both are measured from their ref. */
static void let_mimic(struct Mjcf *mjcf, xmlNodePtr node, struct RobotJoint *joint, const struct RobotJoint *other,
                      const double coefficient[2]) {
  if (joint->mimicked_name != NULL)
    mjcf_error(mjcf, node, "the joint '%s' follows '%s' already; expected one <equality> for each joint1", joint->name,
               joint->mimicked_name);
  joint->mimicked_name = other->name;
  joint->multiplier = coefficient[1];
  joint->offset = joint->start.position[0] + coefficient[0] - coefficient[1] * other->start.position[0];
}

/* Reads a polynomial relation of two joints, or a constant position of one. A linear one makes joint1 mimic joint2. */
static void read_joints(struct Mjcf *mjcf, xmlNodePtr node) {
  struct Coupling coupling = {.name = attribute(node, "name"), .line = line_of(node), .coefficient = {0, 1}};
  double *c = coupling.coefficient;
  bool has_other = has_attribute(node, "joint2");
  struct RobotJoint *joint = find_joint(mjcf, node, "joint1"),
                    *other = has_other ? find_joint(mjcf, node, "joint2") : NULL;
  mjcf_numbers(mjcf, node, "polycoef", 1, COUPLING_POWERS, c);
  if (joint == NULL || (has_other && other == NULL)) return;
  if (other != NULL && c[2] == 0 && c[3] == 0 && c[4] == 0) {
    let_mimic(mjcf, node, joint, other, c);
    return;
  }
  if (coupling.name == NULL) coupling.name = format_text("joints%zu", mjcf->file.robot->coupling_count + 1);
  coupling.parts[0] = part_of_joint(joint);
  if (other != NULL) coupling.parts[1] = part_of_joint(other);
  add_coupling(mjcf, coupling);
}

/* The ends of a loop: two sites, or two bodies. The second body is the world if the element names none. */
struct Ends {
  char *names[2];
  const struct Placement *placements[2]; /* in the world, with all joints at their ref */
};

/* Reads the ends. Returns false after reporting one that does not exist. */
static bool read_ends(struct Mjcf *mjcf, xmlNodePtr node, struct Ends *ends) {
  static const char *const of_bodies[] = {"body1", "body2"}, *const of_sites[] = {"site1", "site2"};
  const char *const *names = has_attribute(node, "site1") ? of_sites : of_bodies;
  for (int i = 0; i < 2; i++) {
    bool is_world = names == of_bodies && i == 1 && !has_attribute(node, names[i]);
    ends->names[i] = is_world ? copy_text(mjcf_world) : required_attribute(&mjcf->file, node, names[i]);
    if (names == of_sites) ends->names[i] = mjcf_site(mjcf, ends->names[i]);
    ends->placements[i] = mjcf_placement_of(mjcf, ends->names[i]);
    if (ends->placements[i] == NULL && *ends->names[i] != '\0')
      mjcf_error(mjcf, node, "there is no %s '%s' for a <%s>; expected an existing name",
                 names == of_sites ? "site" : "body", ends->names[i], (const char *)node->name);
  }
  return ends->placements[0] != NULL && ends->placements[1] != NULL;
}

/* Adds a link that is fixed to a body and returns its name. */
static char *add_end(struct Mjcf *mjcf, xmlNodePtr node, char *body, char *name, const struct Placement *placement) {
  mjcf_add_link(mjcf, node, name);
  mjcf_fix(mjcf, node, body, name, placement);
  return name;
}

/* Fixes the second body to the first by relpose, or as placed with all joints at their ref. */
static void weld_bodies(struct Mjcf *mjcf, xmlNodePtr node, struct Ends *ends, const char *loop) {
  struct Placement placement = placement_between(ends->placements[0], ends->placements[1]);
  double pose[7] = {0};
  mjcf_numbers(mjcf, node, "relpose", 7, 7, pose);
  if (pose[3] != 0 || pose[4] != 0 || pose[5] != 0 || pose[6] != 0) {
    placement.rotation = rotation_of_quaternion(&pose[3]);
    memcpy(placement.translation, pose, sizeof placement.translation);
  }
  ends->names[0] = add_end(mjcf, node, ends->names[0], format_text("%s_1", loop), &placement);
}

/* Connects both bodies at the anchor, which is given in the first one. */
static void connect_bodies(struct Mjcf *mjcf, xmlNodePtr node, struct Ends *ends, const char *loop) {
  struct Placement anchor = no_displacement, between = placement_between(ends->placements[1], ends->placements[0]);
  if (mjcf_numbers(mjcf, node, "anchor", 3, 3, anchor.translation) == 0)
    required_attribute(&mjcf->file, node, "anchor");
  struct Placement other = placement_within(&between, &anchor);
  other.rotation = no_displacement.rotation;
  ends->names[0] = add_end(mjcf, node, ends->names[0], format_text("%s_1", loop), &anchor);
  ends->names[1] = add_end(mjcf, node, ends->names[1], format_text("%s_2", loop), &other);
}

static void read_loop(struct Mjcf *mjcf, xmlNodePtr node) {
  struct Robot *robot = mjcf->file.robot;
  struct Ends ends;
  char *name = attribute(node, "name");
  name = name != NULL ? format_text("%s_loop", name) : format_text("loop%zu", robot->loop_count + 1);
  if (!read_ends(mjcf, node, &ends)) return;
  bool is_fixed = is_element(node, "weld");
  if (is_fixed && mjcf_number(mjcf, node, "torquescale", 1) == 0)
    mjcf_error(mjcf, node, "torquescale=\"0\" of <weld> constrains no rotation; expected a <connect>");
  if (!has_attribute(node, "site1") && is_fixed) weld_bodies(mjcf, node, &ends, name);
  else if (!has_attribute(node, "site1")) connect_bodies(mjcf, node, &ends, name);
  APPEND(robot->loops, robot->loop_count,
         (struct RobotLoop){
             .name = name, .line = line_of(node), .is_fixed = is_fixed, .link_names = {ends.names[0], ends.names[1]}});
}

/* Reads a polynomial relation of two tendons, or a constant length of one. */
static void read_tendons(struct Mjcf *mjcf, xmlNodePtr node) {
  struct Robot *robot = mjcf->file.robot;
  struct Coupling coupling = {.name = attribute(node, "name"), .line = line_of(node), .coefficient = {0, 1}};
  if (coupling.name == NULL) coupling.name = format_text("tendons%zu", robot->coupling_count + 1);
  mjcf_numbers(mjcf, node, "polycoef", 1, COUPLING_POWERS, coupling.coefficient);
  bool has_other = has_attribute(node, "tendon2");
  const char *names[2] = {required_attribute(&mjcf->file, node, "tendon1"), attribute(node, "tendon2")};
  if (*names[0] == '\0') return; /* the error has been reported */
  if (has_other && strcmp(names[0], names[1]) == 0) {
    report_error(mjcf->file.diagnostics, coupling.line, "the tendon '%s' is its own tendon2; expected another one",
                 names[0]);
    return;
  }
  for (int i = 0; i < (has_other ? 2 : 1); i++) {
    const struct Tendon *tendon = mjcf_tendon(mjcf, node, names[i]);
    if (tendon == NULL) return;
    coupling.parts[i] =
        (struct CoupledPart){.name = tendon->name, .transmission = tendon->transmission, .start = tendon->start};
  }
  add_coupling(mjcf, coupling);
}

void mjcf_read_equality(struct Mjcf *mjcf, xmlNodePtr node) {
  if (mjcf_is(mjcf, node, "active", "false")) return;
  if (is_element(node, "joint")) read_joints(mjcf, node);
  else if (is_element(node, "connect") || is_element(node, "weld")) read_loop(mjcf, node);
  else if (is_element(node, "tendon")) read_tendons(mjcf, node);
  else mjcf_report_unknown(mjcf, node, "a <joint>, <tendon>, <connect> or <weld>");
}
