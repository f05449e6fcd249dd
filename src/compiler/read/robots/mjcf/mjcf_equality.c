#include "read/robots/mjcf/mjcf_equality.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "read/robots/mjcf/mjcf_tendons.h"
#include "read/robots/mjcf/mjcf_tree.h"
#include "read/xml/nodes.h"

/* Reads a linear relation of two joints, measured from their ref, as mimicking. */
static void read_joints(struct Mjcf *mjcf, xmlNodePtr node) {
  double c[5] = {0, 1};
  char *names[2] = {required_attribute(&mjcf->file, node, "joint1"), required_attribute(&mjcf->file, node, "joint2")};
  struct RobotJoint *joints[2] = {mjcf_joint(mjcf, names[0]), mjcf_joint(mjcf, names[1])};
  mjcf_numbers(mjcf, node, "polycoef", 1, 5, c);
  for (int i = 0; i < 2; i++)
    if (joints[i] == NULL && *names[i] != '\0')
      report_error(mjcf->file.diagnostics, line_of(node),
                   "there is no joint '%s' for an <equality>; expected an existing name", names[i]);
  if (c[2] != 0 || c[3] != 0 || c[4] != 0)
    report_error(mjcf->file.diagnostics, line_of(node),
                 "polycoef of <joint> is not linear; expected a <constraint> in a <system> that includes the robot");
  if (joints[0] == NULL || joints[1] == NULL) return;
  if (joints[0]->mimicked_name != NULL)
    report_error(mjcf->file.diagnostics, line_of(node),
                 "the joint '%s' follows '%s' already; expected one <equality> for each joint1", names[0],
                 joints[0]->mimicked_name);
  joints[0]->mimicked_name = names[1];
  joints[0]->multiplier = c[1];
  joints[0]->offset = joints[0]->start.position[0] + c[0] - c[1] * joints[1]->start.position[0];
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
      report_error(mjcf->file.diagnostics, line_of(node), "there is no %s '%s' for a <%s>; expected an existing name",
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
    report_error(mjcf->file.diagnostics, line_of(node),
                 "torquescale=\"0\" of <weld> constrains no rotation; expected a <connect>");
  if (!has_attribute(node, "site1") && is_fixed) weld_bodies(mjcf, node, &ends, name);
  else if (!has_attribute(node, "site1")) connect_bodies(mjcf, node, &ends, name);
  robot->loops = make_room(robot->loops, robot->loop_count, sizeof *robot->loops);
  robot->loops[robot->loop_count++] = (struct RobotLoop){
      .name = name, .line = line_of(node), .is_fixed = is_fixed, .link_names = {ends.names[0], ends.names[1]}};
}

/* Reads a polynomial relation of two tendons, or a constant length of one. */
static void read_tendons(struct Mjcf *mjcf, xmlNodePtr node) {
  struct Robot *robot = mjcf->file.robot;
  struct TendonLink link = {.name = attribute(node, "name"), .line = line_of(node), .coefficient = {0, 1}};
  if (link.name == NULL) link.name = format_text("tendons%zu", robot->tendon_link_count + 1);
  mjcf_numbers(mjcf, node, "polycoef", 1, TENDON_POWERS, link.coefficient);
  bool has_other = has_attribute(node, "tendon2");
  const char *names[2] = {required_attribute(&mjcf->file, node, "tendon1"), attribute(node, "tendon2")};
  if (*names[0] == '\0') return; /* the error has been reported */
  if (has_other && strcmp(names[0], names[1]) == 0) {
    report_error(mjcf->file.diagnostics, link.line, "the tendon '%s' is its own tendon2; expected another one",
                 names[0]);
    return;
  }
  for (int i = 0; i < (has_other ? 2 : 1); i++) {
    const struct Tendon *tendon = mjcf_tendon(mjcf, node, names[i]);
    if (tendon == NULL) return;
    link.tendons[i] = (size_t)(tendon - robot->tendons);
  }
  for (int power = 1; power < TENDON_POWERS && !has_other; power++) link.coefficient[power] = 0;
  robot->tendon_links = make_room(robot->tendon_links, robot->tendon_link_count, sizeof *robot->tendon_links);
  robot->tendon_links[robot->tendon_link_count++] = link;
}

void mjcf_read_equality(struct Mjcf *mjcf, xmlNodePtr node) {
  if (mjcf_is(mjcf, node, "active", "false")) return;
  if (is_element(node, "joint")) read_joints(mjcf, node);
  else if (is_element(node, "connect") || is_element(node, "weld")) read_loop(mjcf, node);
  else if (is_element(node, "tendon")) read_tendons(mjcf, node);
  else mjcf_report_unknown(mjcf, node, "a <joint>, <tendon>, <connect> or <weld>");
}
