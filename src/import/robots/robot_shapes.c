#include "robots/robot_shapes.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "model/kinematics.h"
#include "robots/description/robot_file.h"
#include "robots/description/shape_pairs.h"
#include "robots/robot_tree.h"

static const char ground[] = "ground";

/*
 * m: depth at which a single contact point bears the whole weight, which sets the stiffness. s/m: damping. Coefficient
 * of friction, if the file gives none.
 */
static const double sinking = 1e-3, usual_damping = 2.0, usual_friction = 0.8;

/* m/s^2: gravitational acceleration that sets the stiffness of a robot without weight. */
static const double usual_gravity = 9.81;

static void place_element(xmlNodePtr shape, const struct Placement *placement) {
  static const char *const names[] = {"roll", "pitch", "yaw"};
  double angles[3];
  placement_angles(placement, angles);
  for (int axis = 0; axis < 3; axis++) {
    set_number(shape, axes[axis], placement->translation[axis]);
    set_number(shape, names[axis], angles[axis]);
  }
}

/* Returns a coefficient of friction, or the usual one if it is NAN. */
static double shape_friction(double friction) {
  return isnan(friction) ? usual_friction : friction;
}

bool meets_ground(const struct RobotOptions *options, const struct RobotLink *link, const struct Collision *shape) {
  return !shape->is_clear && link_touches_ground(options, link->name);
}

/* Returns the coefficient of friction of all shapes on the ground; NAN if they differ. */
static double common_friction(const struct Robot *robot, const struct RobotOptions *options) {
  double common = usual_friction;
  bool is_first = true;
  for (size_t i = 0; i < robot->link_count; i++) {
    const struct RobotLink *link = robot->links[i];
    for (size_t j = 0; j < link->collision_count; j++) {
      if (!carrier_moves(link, options->floats) || !meets_ground(options, link, &link->collisions[j])) continue;
      double friction = shape_friction(link->collisions[j].friction);
      if (!is_first && friction != common) return NAN;
      common = friction;
      is_first = false;
    }
  }
  return common;
}

/* Writes PREFIX_stiffness, PREFIX_damping and PREFIX_friction. friction: NAN where contacts differ. */
static void write_contact_parameters(const struct Writer *writer, const struct Robot *robot, const char *prefix,
                                     double friction) {
  double mass = 0.0;
  for (size_t i = 0; i < robot->link_count; i++) mass += robot->links[i]->body.mass;
  double gravity = robot_gravity(robot);
  double stiffness = fmax(mass, 1e-3) * (gravity > 0.0 ? gravity : usual_gravity) / sinking;
  if (stiffness > 1.0) stiffness = floor(stiffness);
  write_parameter(writer, format_text("%s_stiffness", prefix), stiffness, "N/m",
                  "force by depth at each point that touches");
  write_parameter(writer, format_text("%s_damping", prefix), usual_damping, "s/m",
                  "by which the force grows with the speed");
  write_parameter(writer, format_text("%s_friction", prefix), isnan(friction) ? -1 : friction, "1",
                  isnan(friction) ? "coefficient of friction of all shapes; below 0, each has that of the file"
                                  : "coefficient of friction");
}

void write_ground(struct Writer *writer, const struct Robot *robot) {
  double friction = common_friction(robot, writer->options);
  writer->has_own_frictions = isnan(friction);
  writer->line = robot->line;
  write_contact_parameters(writer, robot, ground, friction);
  xmlNodePtr plane = write_element(writer, "shape", "name", ground, "type", "plane", NULL);
  if (robot->ground != NULL) place_element(plane, &robot->ground->placement);
}

/* Writes a compliant contact with these parameters. friction: its own coefficient; NAN for that of the parameter. */
static void write_shape_contact(const struct Writer *writer, char *name, char *const shapes[2], const char *prefix,
                                double friction) {
  write_element(writer, "contact", "name", name, "between", shapes[0], "and", shapes[1], "stiffness",
                format_text("%s_stiffness", prefix), "damping", format_text("%s_damping", prefix), "friction",
                isnan(friction) ? format_text("%s_friction", prefix)
                                : format_text("if(%s_friction < 0, %s, %s_friction)", prefix, number(friction), prefix),
                NULL);
}

static void write_contact(const struct Writer *writer, const struct RobotLink *link, const struct Collision *collision,
                          char *shape, size_t index) {
  write_shape_contact(writer, format_text("%s_%s%zu", link->symbol, ground, index),
                      (char *const[]){shape, copy_text(ground)}, ground,
                      writer->has_own_frictions ? shape_friction(collision->friction) : NAN);
}

static xmlNodePtr write_shape(struct Writer *writer, const struct RobotLink *link, const struct Collision *collision,
                              char *name) {
  static const char *const sizes[] = {"sizeX", "sizeY", "sizeZ"};
  const double *scale = collision->scale;
  writer->line = collision->line;
  xmlNodePtr shape = write_element(writer, "shape", "name", name, "in", link->symbol, "type", collision->type, NULL);
  place_element(shape, &collision->placement);
  for (int axis = 0; axis < 3; axis++) set_number(shape, sizes[axis], collision->size[axis]);
  set_number(shape, "radius", collision->radius);
  set_number(shape, "length", collision->length);
  if (collision->color != NULL) set_attribute(shape, "color", collision->color);
  if (collision->file == NULL) return shape;
  char *x = number(scale[0]), *y = number(scale[1]), *z = number(scale[2]);
  set_attribute(shape, "file", collision->file);
  set_attribute(shape, "scale", format_text("%s %s %s", x, y, z));
  return shape;
}

/* True for a cylinder about the axis of a joint that turns without limits: a wheel, which rolls and does not stand. */
static bool is_wheel(const struct RobotLink *link, const struct Collision *collision) {
  const struct RobotJoint *joint = link->joint;
  if (strcmp(collision->type, "cylinder") != 0 || joint == NULL) return false;
  if (joint->type != CONTINUOUS && (joint->type != REVOLUTE || !isnan(joint->lower))) return false;
  double along = 0.0;
  for (int i = 0; i < 3; i++) along += collision->placement.rotation.at[i][2] * joint->axis[i];
  return fabs(along) > 1.0 - 1e-6;
}

void write_shapes(struct Writer *writer, const struct RobotLink *link, bool moves) {
  for (size_t i = 0; i < link->collision_count; i++) {
    char *name = collision_name(link, i);
    xmlNodePtr shape = write_shape(writer, link, &link->collisions[i], name);
    if (link->visual_count > 0) set_attribute(shape, "drawn", "false");
    if (is_wheel(link, &link->collisions[i])) set_attribute(shape, "stands", "false");
    if (moves && meets_ground(writer->options, link, &link->collisions[i]) &&
        !has_contact_between(writer->options, name, ground))
      write_contact(writer, link, &link->collisions[i], name, i + 1);
  }
  for (size_t i = 0; i < link->visual_count; i++)
    write_shape(writer, link, &link->visuals[i], format_text("%s_visual%zu", link->symbol, i + 1));
}

/* Returns the link that carries the parent of this carrier; NULL for the root. */
static const struct RobotLink *carrier_before(const struct RobotLink *carrier) {
  return carrier->joint != NULL ? carrier->joint->parent->carrier : NULL;
}

/* True if the shapes of two links may meet. Shapes of links that a joint connects often overlap, and touch nothing. */
static bool may_meet(const struct RobotLink *first, const struct RobotLink *second) {
  const struct RobotLink *a = first->carrier, *b = second->carrier;
  return a != b && carrier_before(a) != b && carrier_before(b) != a;
}

void find_pairs(struct Robot *robot, const struct RobotOptions *options, const struct Diagnostics *diagnostics) {
  struct ShapePair other = {.links = {NULL}};
  size_t others = 0;
  for (struct RobotLink *first = options->has_self ? robot->root : NULL; first != NULL; first = first->next)
    for (struct RobotLink *second = first->next; second != NULL; second = second->next)
      for (size_t i = 0; i < first->collision_count && may_meet(first, second); i++)
        for (size_t j = 0; j < second->collision_count; j++) {
          struct ShapePair pair = {{first, second}, {i, j}, NAN, first->collisions[i].line};
          if (touch_in_system(options, &pair)) continue;
          if (shapes_can_touch(&first->collisions[i], &second->collisions[j])) add_shape_pair(robot, &pair);
          else if (others++ == 0) other = pair;
        }
  if (others == 0) return;
  const char *types[2];
  for (int i = 0; i < 2; i++) types[i] = other.links[i]->collisions[other.indices[i]].type;
  report_warning(diagnostics, other.line,
                 "%zu pair%s of shapes do%s not touch, such as the %s of the link '%s' and the %s of '%s'; expected %s",
                 others, others > 1 ? "s" : "", others > 1 ? "" : "es", types[0], other.links[0]->name, types[1],
                 other.links[1]->name, how_to_touch(options, &other));
}

/* Returns the coefficient that all pairs have; NAN if they differ. */
static double friction_of_pairs(const struct Robot *robot) {
  double common = shape_friction(robot->pairs[0].friction);
  for (size_t i = 1; i < robot->pair_count; i++)
    if (shape_friction(robot->pairs[i].friction) != common) return NAN;
  return common;
}

void write_pairs(struct Writer *writer, const struct Robot *robot) {
  if (robot->pair_count == 0) return;
  double friction = friction_of_pairs(robot);
  writer->line = robot->line;
  write_contact_parameters(writer, robot, "self", friction);
  for (size_t i = 0; i < robot->pair_count; i++) {
    const struct ShapePair *pair = &robot->pairs[i];
    char *names[2];
    for (int k = 0; k < 2; k++) names[k] = collision_name(pair->links[k], pair->indices[k]);
    writer->line = pair->line;
    write_shape_contact(writer, format_text("%s_on_%s", names[0], names[1]), names, "self",
                        isnan(friction) ? pair->friction : NAN);
  }
}
