#include "robots/mjcf/values/mjcf_tree.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "xml/nodes.h"

const char mjcf_world[] = "world";

struct RobotLink *mjcf_add_link(struct Mjcf *mjcf, xmlNodePtr node, char *name) {
  struct RobotLink *link = allocate(1, sizeof *link);
  link->name = name;
  link->line = line_of(node);
  add_link(&mjcf->file, link);
  return link;
}

void mjcf_note_bodies(struct Mjcf *mjcf, xmlNodePtr node) {
  for (xmlNodePtr child = node->children; child != NULL; child = child->next) {
    if (child->type != XML_ELEMENT_NODE) continue;
    char *name = is_element(child, "body") ? attribute(child, "name") : NULL;
    if (name != NULL) names_set(mjcf->bodies, name, copy_text(name));
    mjcf_note_bodies(mjcf, child);
  }
}

char *mjcf_site_link(const struct Mjcf *mjcf, char *name) {
  bool is_taken = strcmp(name, mjcf_world) == 0 || names_find(mjcf->bodies, name) != NULL;
  return is_taken ? format_text("%s_site", name) : name;
}

char *mjcf_site(const struct Mjcf *mjcf, char *name) {
  char *link = mjcf_site_link(mjcf, name);
  return mjcf_placement_of(mjcf, link) != NULL ? link : name;
}

xmlNodePtr mjcf_body_around(xmlNodePtr node) {
  while (is_element(node->parent, "frame")) node = node->parent;
  return node->parent;
}

bool mjcf_is_joint(xmlNodePtr node) {
  return is_element(node, "joint") || is_element(node, "freejoint");
}

bool mjcf_has_joint(xmlNodePtr body) {
  xmlNodePtr node = body->children;
  while (node != NULL && !mjcf_is_joint(node)) node = node->next;
  return node != NULL;
}

bool mjcf_moves(const struct Mjcf *mjcf, xmlNodePtr body) {
  if (mjcf_has_joint(body)) return true;
  return mjcf->file.options->floats && is_element(mjcf_body_around(body), "worldbody") &&
         !attribute_is(body, "mocap", "true");
}

struct RobotJoint *mjcf_add_joint(struct Mjcf *mjcf, xmlNodePtr node, enum RobotJointType type, char *name,
                                  char *parent, char *child) {
  struct RobotJoint *joint = allocate(1, sizeof *joint);
  joint->name = name;
  joint->line = line_of(node);
  joint->type = type;
  joint->parent_name = parent;
  joint->child_name = child;
  joint->origin = no_displacement;
  joint->axis[2] = 1;
  joint->lower = joint->upper = joint->effort = joint->actuator_limits[0] = joint->actuator_limits[1] = NAN;
  joint->multiplier = 1;
  add_joint(&mjcf->file, joint);
  return joint;
}

struct RobotJoint *mjcf_joint(const struct Mjcf *mjcf, const char *name) {
  const struct Robot *robot = mjcf->file.robot;
  for (size_t i = 0; i < robot->joint_count; i++)
    if (strcmp(robot->joints[i]->name, name) == 0) return robot->joints[i];
  return NULL;
}

void mjcf_fix(struct Mjcf *mjcf, xmlNodePtr node, char *parent, char *child, const struct Placement *placement) {
  mjcf_add_joint(mjcf, node, FIXED, format_text("%s_fixed", child), parent, child)->origin = *placement;
}

void mjcf_note_placement(struct Mjcf *mjcf, const char *name, const char *parent, const struct Placement *placement) {
  const struct Placement *outer = parent != NULL ? mjcf_placement_of(mjcf, parent) : NULL;
  struct Placement *known = allocate(1, sizeof *known);
  *known = placement_within(outer != NULL ? outer : &no_displacement, placement);
  names_set(mjcf->placements, name, known);
}

const struct Placement *mjcf_placement_of(const struct Mjcf *mjcf, const char *name) {
  return names_find(mjcf->placements, name);
}
