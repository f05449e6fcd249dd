/*
 * Conversion of MJCF to links and joints.
 *
 * A body with n joints becomes a chain of n links, the last of which is the body; the others have no mass. The frame of
 * a joint has its origin at the anchor `pos`. If the last anchor is not the origin of the body, one more link at the
 * anchor carries the body by a fixed joint. A hinge or slide is at `ref` when its body is as placed, so that the
 * constant placement of the joint includes the displacement by -ref. Sites become links that are fixed to their body.
 * Geoms give inertias and shapes.
 *
 * Sections are read in the order of their dependencies: compiler, option, contact rules, geoms of the world, bodies,
 * tendons, actuators, equalities, keyframe. Defaults are looked up in the classes of each element, see mjcf_values.c.
 */
#include "robots/mjcf/mjcf.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "robots/mjcf/mjcf_contacts.h"
#include "robots/expansion/mjcf_attachments.h"
#include "robots/expansion/mjcf_includes.h"
#include "robots/expansion/mjcf_replicas.h"
#include "robots/mjcf/values/mjcf_tree.h"
#include "robots/mjcf/mjcf_sections.h"
#include "xml/nodes.h"

/* Reports unsupported elements, at any depth, that would change the motion. */
static void check_elements(struct Mjcf *mjcf, xmlNodePtr node) {
  static const char *const rejected[][2] = {{"attach", "it in a <body>, a <frame> or the <worldbody>"},
                                            {"composite", "rigid bodies"},
                                            {"flexcomp", "rigid bodies"},
                                            {"flex", "rigid bodies"},
                                            {"plugin", "a file without it"}};
  for (xmlNodePtr child = node->children; child != NULL; child = child->next) {
    if (child->type != XML_ELEMENT_NODE || is_element(child, "sensor") || is_element(child, "asset")) continue;
    for (size_t i = 0; i < sizeof rejected / sizeof *rejected; i++)
      if (is_element(child, rejected[i][0])) mjcf_report_unknown(mjcf, child, rejected[i][1]);
    check_elements(mjcf, child);
  }
}

/* Gives the robot's file and the attached ones the usual settings. */
static void make_compilers(struct Mjcf *mjcf, size_t attached_count) {
  static const struct MjcfCompiler usual = {.inertia_groups = {0, 5}, .has_automatic_limits = true};
  mjcf->attached_count = attached_count;
  mjcf->compilers = allocate(attached_count + 1, sizeof *mjcf->compilers);
  for (size_t i = 0; i <= attached_count; i++) {
    mjcf->compilers[i] = usual;
    mjcf->compilers[i].angles = usual_angles;
  }
}

static void read_compiler(struct Mjcf *mjcf, xmlNodePtr node) {
  static const char *const units[] = {"degree", "radian", NULL}, *const where[] = {"auto", "true", "false", NULL};
  size_t model = mjcf_model_of(node);
  struct MjcfCompiler *compiler = &mjcf->compilers[model];
  mjcf_word(mjcf, node, "angle", units);
  mjcf_read_angles(node, &compiler->angles);
  if (has_attribute(node, mjcf_file_note)) compiler->file = attribute(node, mjcf_file_note);
  if (has_attribute(node, "autolimits")) compiler->has_automatic_limits = attribute_is(node, "autolimits", "true");
  if (has_attribute(node, "alignfree")) compiler->aligns_free = attribute_is(node, "alignfree", "true");
  if (has_attribute(node, "inertiafromgeom"))
    compiler->inertia_from_geoms = (enum InertiaFromGeoms)mjcf_word(mjcf, node, "inertiafromgeom", where);
  compiler->least_mass = mjcf_number_not_negative(mjcf, node, "boundmass", compiler->least_mass);
  compiler->least_moment = mjcf_number_not_negative(mjcf, node, "boundinertia", compiler->least_moment);
  if (has_attribute(node, "balanceinertia")) compiler->balances_moments = attribute_is(node, "balanceinertia", "true");
  if (has_attribute(node, "fitaabb")) compiler->fits_bounds = attribute_is(node, "fitaabb", "true");
  if (mjcf->attached_count > 0 && attribute_is(node, "conflict", "merge"))
    mjcf_error(mjcf, node, "conflict=\"merge\" of <compiler> is not read; expected the <option>s in the robot's file");
  if (model == 0) mjcf->total_mass = mjcf_number(mjcf, node, "settotalmass", mjcf->total_mass);
  mjcf_numbers(mjcf, node, "inertiagrouprange", 2, 2, compiler->inertia_groups);
  if (has_attribute(node, "coordinate") && !attribute_is(node, "coordinate", "local"))
    mjcf_error(mjcf, node, "coordinate=\"%s\" of <compiler> is not read; expected local",
               attribute(node, "coordinate"));
  if (has_attribute(node, "assetdir") && compiler->mesh_folder == NULL)
    compiler->mesh_folder = attribute(node, "assetdir");
  if (has_attribute(node, "meshdir")) compiler->mesh_folder = attribute(node, "meshdir");
  const char *sequence = attribute(node, "eulerseq");
  if (sequence != NULL && strcmp(sequence, compiler->angles.sequence) != 0)
    mjcf_error(mjcf, node,
               "eulerseq=\"%.60s\" of <compiler> is not valid; expected three of the letters x, y, z, X, Y, Z",
               sequence);
}

static void read_option(struct Mjcf *mjcf, xmlNodePtr node) {
  double groups[ACTUATOR_GROUPS];
  struct Fluid *fluid = &mjcf->file.robot->fluid;
  mjcf_numbers(mjcf, node, "gravity", 3, 3, mjcf->file.robot->gravity);
  fluid->density = mjcf_number_not_negative(mjcf, node, "density", fluid->density);
  fluid->viscosity = mjcf_number_not_negative(mjcf, node, "viscosity", fluid->viscosity);
  mjcf_numbers(mjcf, node, "wind", 3, 3, fluid->wind);
  size_t count = mjcf_numbers(mjcf, node, "actuatorgroupdisable", 1, ACTUATOR_GROUPS, groups);
  for (size_t i = 0; i < count; i++)
    if (groups[i] >= 0 && groups[i] < ACTUATOR_GROUPS) mjcf->is_off[(size_t)groups[i]] = true;
  xmlNodePtr flag = child_of(&mjcf->file, node, "flag");
  if (flag != NULL) mjcf_read_flag(mjcf, flag);
}

static void read_axis(struct Mjcf *mjcf, xmlNodePtr node, struct RobotJoint *joint) {
  mjcf_numbers(mjcf, node, "axis", 3, 3, joint->axis);
  if (make_unit(joint->axis) == 0)
    mjcf_error(mjcf, node, "the axis of the joint '%s' has the length 0; expected a direction such as 0 0 1",
               joint->name);
}

/* Reads a hinge or slide. Its coordinate is `ref` when its body is as placed. */
static void read_single(struct Mjcf *mjcf, xmlNodePtr node, struct RobotJoint *joint) {
  double scale = joint->type == REVOLUTE ? mjcf_compiler(mjcf, node)->angles.unit : 1, limits[2];
  read_axis(mjcf, node, joint);
  joint->start.position[0] = mjcf_number(mjcf, node, "ref", 0) * scale;
  joint->rest = mjcf_number(mjcf, node, "springref", 0) * scale;
  joint->stiffness = mjcf_number_not_negative(mjcf, node, "stiffness", 0);
  joint->damping = mjcf_number_not_negative(mjcf, node, "damping", 0);
  joint->armature = mjcf_number_not_negative(mjcf, node, "armature", 0);
  joint->friction = mjcf_number_not_negative(mjcf, node, "frictionloss", 0);
  mjcf_note_spring(mjcf, node, joint);
  mjcf_limits(mjcf, node, "actuatorfrcrange", "actuatorfrclimited", joint->actuator_limits);
  mjcf_limits(mjcf, node, "range", "limited", limits);
  joint->lower = limits[0] * scale;
  joint->upper = limits[1] * scale;
  struct Placement back = no_displacement;
  if (joint->type == REVOLUTE) back.rotation = rotation_about(joint->axis, -joint->start.position[0]);
  else
    for (int i = 0; i < 3; i++) back.translation[i] = -joint->axis[i] * joint->start.position[0];
  joint->origin = placement_within(&joint->origin, &back);
}

/* Sets the largest angle by which a ball joint may be rotated. */
static void read_cone(struct Mjcf *mjcf, xmlNodePtr node, struct RobotJoint *joint) {
  double limits[2];
  mjcf_limits(mjcf, node, "range", "limited", limits);
  if (isnan(limits[0])) return;
  if (limits[0] != 0)
    mjcf_error(mjcf, node, "range of the ball joint '%s' begins at %g; expected 0 and the largest angle", joint->name,
               limits[0]);
  joint->lower = 0;
  joint->upper = limits[1] * mjcf_compiler(mjcf, node)->angles.unit;
}

/* Reads a joint with several coordinates: isotropic damping and armature. Reports features of single coordinates. */
static void read_several(struct Mjcf *mjcf, xmlNodePtr node, struct RobotJoint *joint) {
  mjcf_reject(mjcf, node, "stiffness springdamper actuatorfrcrange");
  joint->damping = mjcf_number_not_negative(mjcf, node, "damping", 0);
  joint->armature = mjcf_number_not_negative(mjcf, node, "armature", 0);
  if (joint->type == FLOATING) joint->friction = mjcf_number_not_negative(mjcf, node, "frictionloss", 0);
  else mjcf_reject(mjcf, node, "frictionloss");
  if (joint->type == BALL) read_cone(mjcf, node, joint);
}

/* True if a body or one in it has gravcomp. */
static bool is_balanced(struct Mjcf *mjcf, xmlNodePtr body) {
  bool found = is_element(body, "body") && mjcf_number(mjcf, body, "gravcomp", 0) != 0;
  for (xmlNodePtr child = body->children; child != NULL && !found; child = child->next)
    found = is_balanced(mjcf, child);
  return found;
}

/* Warns where MuJoCo's actuators, by actuatorgravcomp, balance less than the weight: beyond a limit, or without any. */
static void warn_of_balance(struct Mjcf *mjcf, xmlNodePtr node, const struct RobotJoint *joint) {
  bool has_actuators = false, is_limited = !isnan(joint->actuator_limits[0]);
  if (!mjcf_is(mjcf, node, "actuatorgravcomp", "true") || !is_balanced(mjcf, node->parent)) return;
  for (xmlNodePtr section = mjcf->root->children; section != NULL; section = section->next)
    has_actuators |= is_element(section, "actuator") && xmlFirstElementChild(section) != NULL;
  if (!has_actuators)
    warn_unread(&mjcf->file, line_of(node), "actuatorgravcomp=\"true\" in a file without actuators",
                "gravcomp=\"0\" of the <body>s, as nothing balances them in MuJoCo");
  else if (is_limited)
    warn_unread(&mjcf->file, line_of(node), "the limit of actuatorgravcomp by actuatorfrcrange",
                "actuatorgravcomp=\"false\", or no actuatorfrcrange");
}

/* Warns of a <freejoint> for which MuJoCo moves the frame of the body to its centre of mass and principal axes. */
static void warn_of_alignment(const struct Mjcf *mjcf, xmlNodePtr node, const char *body) {
  const char *align = is_element(node, "freejoint") ? attribute(node, "align") : "false";
  bool is_given = align != NULL && strcmp(align, "auto") != 0;
  if (is_given ? strcmp(align, "true") != 0 : !mjcf_compiler(mjcf, node)->aligns_free) return;
  report_warning(mjcf->file.diagnostics, line_of(node),
                 "start values, keyframes and motors at this free joint hold for the frame of the body '%s', unlike in "
                 "MuJoCo, which moves it to the centre of mass; expected align=\"false\"",
                 body);
}

/* Sets the start of a free joint to the placement of its body, with the quaternion of its roll, pitch and yaw. */
static void read_free(struct Mjcf *mjcf, struct RobotJoint *joint, const struct Placement *placement) {
  double angles[3], s[3], c[3];
  if (strcmp(joint->parent_name, mjcf_world) != 0)
    report_error(mjcf->file.diagnostics, joint->line,
                 "the free joint '%s' is in the body '%s'; expected it in a <body> of the <worldbody>", joint->name,
                 joint->child_name);
  placement_angles(placement, angles);
  for (int i = 0; i < 3; i++) {
    joint->start.position[i] = placement->translation[i];
    s[i] = sin(angles[i] / 2);
    c[i] = cos(angles[i] / 2);
  }
  joint->start.position[3] = c[0] * c[1] * c[2] + s[0] * s[1] * s[2];
  joint->start.position[4] = s[0] * c[1] * c[2] - c[0] * s[1] * s[2];
  joint->start.position[5] = c[0] * s[1] * c[2] + s[0] * c[1] * s[2];
  joint->start.position[6] = c[0] * c[1] * s[2] - s[0] * s[1] * c[2];
}

/* The joints of a body, connected in series by massless links. */
struct Chain {
  char *body, *parent;        /* the last link so far */
  struct Placement placement; /* of the body in that link, if all remaining joints are at their ref */
  size_t count;
  bool is_free, has_body;
};

static void add_to_chain(struct Mjcf *mjcf, xmlNodePtr node, struct Chain *chain, bool is_last) {
  static const char *const words[] = {"hinge", "slide", "ball", "free", NULL};
  static const enum RobotJointType types[] = {REVOLUTE, PRISMATIC, BALL, FLOATING};
  enum RobotJointType type = is_element(node, "freejoint") ? FLOATING : types[mjcf_word(mjcf, node, "type", words)];
  char *name = attribute(node, "name");
  struct Placement anchor = no_displacement, back = no_displacement;
  if (type != FLOATING) mjcf_numbers(mjcf, node, "pos", 3, 3, anchor.translation);
  for (int i = 0; i < 3; i++) back.translation[i] -= anchor.translation[i];
  bool is_offset = back.translation[0] != 0 || back.translation[1] != 0 || back.translation[2] != 0;
  if (name == NULL)
    name = type == FLOATING ? copy_text(chain->body) : format_text("%s_joint%zu", chain->body, chain->count + 1);
  char *child = is_last && !is_offset ? chain->body : format_text("%s_%s", chain->body, name);
  struct RobotJoint *joint = mjcf_add_joint(mjcf, node, type, name, chain->parent, child);
  chain->is_free |= type == FLOATING;
  if (type == FLOATING) {
    warn_of_alignment(mjcf, node, chain->body);
    read_free(mjcf, joint, &chain->placement);
  } else joint->origin = placement_within(&chain->placement, &anchor);
  if (type == REVOLUTE || type == PRISMATIC) read_single(mjcf, node, joint);
  else read_several(mjcf, node, joint);
  warn_of_balance(mjcf, node, joint);
  if (child != chain->body) mjcf_add_link(mjcf, node, child);
  chain->has_body = child == chain->body;
  chain->parent = child;
  chain->placement = back;
  chain->count++;
}

static void read_joints(struct Mjcf *mjcf, xmlNodePtr node, struct Chain *chain) {
  xmlNodePtr last = NULL;
  for (xmlNodePtr child = node->children; child != NULL; child = child->next)
    if (mjcf_is_joint(child)) last = child;
  for (xmlNodePtr child = node->children; child != NULL; child = child->next)
    if (mjcf_is_joint(child)) add_to_chain(mjcf, child, chain, child == last);
  if (chain->is_free && chain->count > 1)
    mjcf_error(mjcf, node, "the body '%s' has a free joint and others; expected the free joint alone", chain->body);
  if (!chain->has_body) mjcf_fix(mjcf, node, chain->parent, chain->body, &chain->placement);
}

/* Lets a body of the world move freely, as if it had a <freejoint>. */
static void set_free(struct Mjcf *mjcf, xmlNodePtr node, const struct Chain *chain) {
  struct RobotJoint *joint = mjcf_add_joint(mjcf, node, FLOATING, copy_text(chain->body), chain->parent, chain->body);
  read_free(mjcf, joint, &chain->placement);
}

/* Lets inputs move a body, which start at its placement. */
static void prescribe(struct Mjcf *mjcf, xmlNodePtr node, const struct Chain *chain) {
  struct RobotJoint *joint = mjcf_add_joint(mjcf, node, PRESCRIBED, copy_text(chain->body), chain->parent, chain->body);
  memcpy(joint->start.position, chain->placement.translation, sizeof chain->placement.translation);
  placement_angles(&chain->placement, &joint->start.position[3]);
}

/* Removes the inertia of a body that inputs move, and its contacts with the ground. */
static void release_mocap(struct RobotLink *link) {
  link->body = (struct RigidBody){0};
  for (size_t i = 0; i < link->collision_count; i++) link->collisions[i].is_clear = true;
}

static void read_children(struct Mjcf *mjcf, xmlNodePtr node, char *parent, const struct Placement *outer);

static void read_body(struct Mjcf *mjcf, xmlNodePtr node, char *parent, const struct Placement *outer) {
  char *name = attribute(node, "name");
  if (name == NULL) name = format_text("body%zu", ++mjcf->unnamed_count);
  struct Placement placement = mjcf_placement(mjcf, node);
  struct Chain chain = {.body = name, .parent = parent, .placement = placement_within(outer, &placement)};
  struct RobotLink *link = mjcf_add_link(mjcf, node, name);
  link->weightless = mjcf_number(mjcf, node, "gravcomp", 0);
  bool is_mocap = attribute_is(node, "mocap", "true"), follows = is_mocap && mjcf->file.options->inputs_move_mocap;
  if (is_mocap && !follows)
    warn_unread(&mjcf->file, line_of(node), "mocap of <body>, which stands still,",
                "mocap=\"inputs\" in an <include>, or --mocap inputs on the command line");
  mjcf_note_placement(mjcf, name, parent, &chain.placement);
  if (follows) prescribe(mjcf, node, &chain);
  else if (!mjcf_has_joint(node) && mjcf_moves(mjcf, node)) set_free(mjcf, node, &chain);
  else read_joints(mjcf, node, &chain);
  mjcf_read_body(mjcf, node, link);
  if (follows) release_mocap(link);
  read_children(mjcf, node, name, &no_displacement);
}

static void read_site(struct Mjcf *mjcf, xmlNodePtr node, char *parent, const struct Placement *outer) {
  char *name = attribute(node, "name");
  if (name == NULL) return;
  struct Placement placement = mjcf_placement(mjcf, node);
  placement = placement_within(outer, &placement);
  name = mjcf_site_link(mjcf, name);
  mjcf_add_link(mjcf, node, name);
  mjcf_fix(mjcf, node, parent, name, &placement);
  mjcf_note_placement(mjcf, name, parent, &placement);
}

/* Reads bodies and sites, also in <frame>s, which transform them. */
static void read_children(struct Mjcf *mjcf, xmlNodePtr node, char *parent, const struct Placement *outer) {
  for (xmlNodePtr child = node->children; child != NULL; child = child->next) {
    if (is_element(child, "body")) read_body(mjcf, child, parent, outer);
    else if (is_element(child, "site")) read_site(mjcf, child, parent, outer);
    else if (is_element(child, "frame")) {
      struct Placement inner = mjcf_placement(mjcf, child);
      inner = placement_within(outer, &inner);
      read_children(mjcf, child, parent, &inner);
    } else if (mjcf_is_joint(child) && !is_element(node, "body"))
      mjcf_error(mjcf, child, "a <%s> is in a <%s>; expected it in a <body>", (const char *)child->name,
                 (const char *)node->name);
  }
}

/* Calls `read` for each section of this name, or if inside for each element in them. */
static void for_each(struct Mjcf *mjcf, const char *section, bool inside, MjcfReader *read) {
  for (xmlNodePtr node = mjcf->root->children; node != NULL; node = node->next) {
    if (!is_element(node, section)) continue;
    if (!inside) read(mjcf, node);
    for (xmlNodePtr child = node->children; inside && child != NULL; child = child->next)
      if (child->type == XML_ELEMENT_NODE) read(mjcf, child);
  }
}

static void read_geoms_of_world(struct Mjcf *mjcf, xmlNodePtr node) {
  mjcf_read_body(mjcf, node, mjcf->file.robot->links[0]);
}

static void read_world(struct Mjcf *mjcf, xmlNodePtr node) {
  read_children(mjcf, node, mjcf->file.robot->links[0]->name, &no_displacement);
}

/* Scales all masses and inertias to the sum that the file sets. */
static void set_total_mass(struct Mjcf *mjcf) {
  const struct Robot *robot = mjcf->file.robot;
  double sum = 0;
  for (size_t i = 0; i < robot->link_count; i++) sum += robot->links[i]->body.mass;
  for (size_t i = 0; i < robot->link_count && mjcf->total_mass > 0 && sum > 0; i++)
    robot->links[i]->body = body_scaled(&robot->links[i]->body, mjcf->total_mass / sum);
}

static void check_world(struct Mjcf *mjcf) {
  xmlNodePtr node = mjcf->root->children;
  while (node != NULL && !is_element(node, "worldbody")) node = node->next;
  if (node == NULL)
    report_error(mjcf->file.diagnostics, mjcf->file.robot->line, "<mujoco> has no <worldbody>; expected one in it");
}

struct Robot *mjcf_read(xmlNodePtr root, const struct RobotOptions *options, struct Diagnostics *diagnostics) {
  static const char *const known[] = {"compiler", "option", "default", "worldbody", "actuator", "equality",
                                      "keyframe", "asset",  "tendon",  "contact",   NULL};
  struct Robot *robot = allocate(1, sizeof *robot);
  struct Mjcf mjcf = {.file = {.robot = robot, .options = options, .diagnostics = diagnostics},
                      .root = root,
                      .meshes = names_create(),
                      .bodies = names_create(),
                      .placements = names_create(),
                      .total_mass = -1};
  int errors = diagnostics->errors;
  robot->name = attribute(root, "model");
  if (robot->name == NULL || *robot->name == '\0') robot->name = copy_text("robot");
  robot->line = line_of(root);
  robot->gravity[2] = -9.81;
  mjcf_insert_files(root, diagnostics);
  make_compilers(&mjcf, mjcf_attach(root, diagnostics));
  check_world(&mjcf);
  mjcf_check_classes(&mjcf, root);
  check_elements(&mjcf, root);
  if (diagnostics->errors > errors) return robot;
  for_each(&mjcf, "compiler", false, read_compiler);
  for_each(&mjcf, "option", false, read_option);
  mjcf_replicate(root, diagnostics);
  mjcf_add_link(&mjcf, root, copy_text(mjcf_world));
  mjcf_note_placement(&mjcf, mjcf_world, NULL, &no_displacement);
  for_each(&mjcf, "contact", true, mjcf_read_rule);
  for_each(&mjcf, "worldbody", false, mjcf_note_bodies);
  for_each(&mjcf, "worldbody", false, read_geoms_of_world);
  for_each(&mjcf, "worldbody", false, read_world);
  set_total_mass(&mjcf);
  for_each(&mjcf, "tendon", true, mjcf_read_tendon);
  for_each(&mjcf, "actuator", true, mjcf_read_actuator);
  mjcf_set_springs(&mjcf);
  for_each(&mjcf, "equality", true, mjcf_read_equality);
  if (options->keyframe != NULL) mjcf_read_keyframe(&mjcf);
  mjcf_remove_disabled(&mjcf);
  if (diagnostics->errors == errors) {
    mjcf_find_contacts(&mjcf);
    mjcf_check_attributes(&mjcf);
  }
  leave_out_others(&mjcf.file, root, known);
  report_left_out(&mjcf.file);
  return robot;
}
