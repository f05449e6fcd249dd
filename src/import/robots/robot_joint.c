#include "robots/robot_joint.h"

#include <math.h>

#include "base/memory.h"
#include "model/kinematics.h"
#include "robots/robot_tree.h"
#include "robots/robot_transmission.h"
#include "robots/urdf.h"

/*
 * rad/s and m/s: velocities at which regularized friction reaches 76 % (tanh 1) of its value. Small compared with
 * typical joint velocities, large enough to keep the equations moderately stiff.
 */
static const double creep_rate = 0.01, creep_velocity = 0.001;

bool joint_slides(const struct RobotJoint *joint) {
  return joint->type == PRISMATIC;
}

const char *joint_unit(const struct RobotJoint *joint) {
  return joint_slides(joint) ? "m" : "rad";
}

void write_friction_parameters(const struct Writer *writer, const struct Robot *robot) {
  static const char meaning[] = "velocity at which friction has 76 % of its full force";
  if (writer->options->sticks) return;
  bool has_rotational = false, has_sliding = false;
  for (size_t i = 0; i < robot->joint_count; i++) {
    const struct RobotJoint *joint = robot->joints[i];
    has_sliding |= joint->friction > 0 && (joint_slides(joint) || joint->type == FLOATING);
    has_rotational |= joint->friction > 0 && !joint_slides(joint);
  }
  for (size_t i = 0; i < robot->tendon_count; i++) {
    bool is_length = transmission_slides(&robot->tendons[i].transmission);
    has_sliding |= robot->tendons[i].friction > 0 && is_length;
    has_rotational |= robot->tendons[i].friction > 0 && !is_length;
  }
  if (has_rotational) write_parameter(writer, "creep_rate", creep_rate, "rad/s", meaning);
  if (has_sliding) write_parameter(writer, "creep_velocity", creep_velocity, "m/s", meaning);
}

/* Expressions of a joint's velocity, and of its ratio to that of its leader. */
struct JointMotion {
  char *velocity, *ratio;
};

/* A ratio between a rotation and a translation is a parameter, as it has a unit. */
char *joint_ratio(const struct RobotJoint *joint) {
  bool has_unit = joint_slides(joint) != joint_slides(joint->leader);
  return has_unit ? format_text("%s_ratio", joint->symbol) : number(joint->ratio);
}

char *joint_position(const struct RobotJoint *joint) {
  if (joint->leader == joint) return copy_text(joint->symbol);
  char *ratio = joint_ratio(joint), *shift = number(fabs(joint->shift));
  return format_text("(%s*%s %c %s)", ratio, joint->leader->symbol, joint->shift < 0 ? '-' : '+', shift);
}

/* Writes the position of a mimicking joint as an output, as it has no coordinate. */
static struct JointMotion write_follower(const struct Writer *writer, const struct RobotJoint *joint,
                                         const char *description) {
  const char *name = joint->symbol, *leader = joint->leader->symbol;
  if (joint_slides(joint) != joint_slides(joint->leader))
    write_parameter(writer, joint_ratio(joint), joint->ratio, joint_slides(joint) ? "m/rad" : "rad/m",
                    format_text("velocity of %s over that of %s", name, leader));
  write_output(writer, name, joint_unit(joint), joint_position(joint), description);
  char *ratio = joint_ratio(joint);
  return (struct JointMotion){.velocity = format_text("(%s*%s_velocity)", ratio, leader), .ratio = ratio};
}

static void write_friction(const struct Writer *writer, const struct RobotJoint *joint,
                           const struct JointMotion *motion) {
  const char *name = joint->symbol;
  write_parameter(writer, format_text("%s_friction", name), joint->friction, joint_slides(joint) ? "N" : "N.m",
                  format_text("Coulomb friction of %s", name));
  if (writer->options->sticks) {
    write_element(writer, "friction", "name", format_text("%s_bearing", name), "velocity", motion->velocity, "force",
                  format_text("%s_friction", name), NULL);
    return;
  }
  set_content(write_element(writer, "force", "coordinate", joint->leader->symbol, NULL),
              format_text("-%s_friction*tanh(%s/%s)*%s", name, motion->velocity,
                          joint_slides(joint) ? "creep_velocity" : "creep_rate", motion->ratio));
}

/* Writes the energies of a joint: kinetic energy of its motor and potential of its spring. */
static void write_energies_of_joint(const struct Writer *writer, const struct RobotJoint *joint,
                                    const struct JointMotion *motion) {
  const char *name = joint->symbol;
  if (joint->armature > 0) {
    write_parameter(writer, format_text("%s_armature", name), joint->armature, joint_slides(joint) ? "kg" : "kg.m2",
                    format_text("inertia of the motor of %s", name));
    set_content(write_element(writer, "kinetic", NULL), format_text("%s_armature*%s^2/2", name, motion->velocity));
  }
  if (joint->stiffness > 0) {
    char *position = joint_position(joint), *rest = number(fabs(joint->rest));
    write_parameter(writer, format_text("%s_stiffness", name), joint->stiffness,
                    joint_slides(joint) ? "N/m" : "N.m/rad", format_text("stiffness of %s", name));
    set_content(write_element(writer, "potential", NULL),
                joint->rest == 0
                    ? format_text("%s_stiffness*%s^2/2", name, position)
                    : format_text("%s_stiffness*(%s %c %s)^2/2", name, position, joint->rest < 0 ? '+' : '-', rest));
  }
}

static void write_dissipation_of_joint(const struct Writer *writer, const struct RobotJoint *joint,
                                       const struct JointMotion *motion) {
  const char *name = joint->symbol;
  if (joint->damping > 0) {
    write_parameter(writer, format_text("%s_damping", name), joint->damping,
                    joint_slides(joint) ? "N.s/m" : "N.m.s/rad", format_text("viscous damping of %s", name));
    set_content(write_element(writer, "dissipation", NULL), format_text("%s_damping*%s^2/2", name, motion->velocity));
  }
  if (joint->friction > 0) write_friction(writer, joint, motion);
}

/* Writes stops. A mimicking joint stops its leader by contacts. */
static void write_stops(const struct Writer *writer, const struct RobotJoint *joint, char *lower, char *upper) {
  if (joint->leader == joint) {
    write_element(writer, "stop", "coordinate", joint->symbol, "min", lower, "max", upper, NULL);
    return;
  }
  write_end_contacts(writer, joint->symbol, joint_unit(joint), joint_position(joint), lower, upper);
}

static void write_limits(const struct Writer *writer, const struct RobotJoint *joint) {
  if (isnan(joint->lower)) return;
  const char *name = joint->symbol;
  char *lower = number(joint->lower), *upper = number(joint->upper);
  if (writer->options->has_stops) {
    write_stops(writer, joint, lower, upper);
    return;
  }
  write_excess_of_limits(writer, name, joint_unit(joint), lower, upper);
}

static void write_single(const struct Writer *writer, const struct RobotJoint *joint, const char *description) {
  struct JointMotion motion;
  if (joint->leader == joint) {
    double effort = writer->options->is_effort_limited ? joint->effort : NAN;
    const char *name = joint->symbol, *unit = joint_unit(joint);
    xmlNodePtr coordinate = joint->has_motor ? write_motor(writer, name, unit, effort, description)
                                             : write_coordinate(writer, name, unit, description);
    set_number(coordinate, "start", joint->start.position[0]);
    set_number(coordinate, "velocityStart", joint->start.velocity[0]);
    motion = (struct JointMotion){.velocity = format_text("%s_velocity", joint->symbol), .ratio = number(1)};
  } else motion = write_follower(writer, joint, description);
  write_energies_of_joint(writer, joint, &motion);
  write_dissipation_of_joint(writer, joint, &motion);
  write_limits(writer, joint);
}

static void write_planar(const struct Writer *writer, const struct RobotJoint *joint, const char *description) {
  static const char *const coordinates[3][2] = {{"x", "m"}, {"y", "m"}, {"angle", "rad"}};
  for (int i = 0; i < 3; i++)
    write_motor(writer, format_text("%s_%s", joint->symbol, coordinates[i][0]), coordinates[i][1], NAN, description);
}

/* Writes the coordinates of a free body from component `first` on: 3 for only the quaternion. */
static void write_components(const struct Writer *writer, const char *name, int first, const struct JointStart *start,
                             const char *description) {
  static const char *const components[7] = {"x", "y", "z", "qw", "qx", "qy", "qz"};
  for (int i = first; i < 7; i++) {
    char *full_name = format_text("%s_%s", name, components[i]);
    xmlNodePtr coordinate = write_coordinate(writer, full_name, i < 3 ? "m" : "1", description);
    set_number(coordinate, "start", start->position[i]);
    set_number(coordinate, "velocityStart", start->velocity[i]);
  }
}

void write_free_coordinates(const struct Writer *writer, const char *name, const struct JointStart *start,
                            const char *description) {
  write_components(writer, name, 0, start, description);
}

/* Returns the start with the identity quaternion if the file gives none. */
static struct JointStart start_of_quaternion(const struct RobotJoint *joint) {
  struct JointStart start = joint->start;
  if (!is_quaternion(&start.position[3])) start.position[3] = 1;
  return start;
}

/*
 * Writes an isotropic inertia and damper, with the energy and dissipation share*factor*square. square: the expression
 * of the squared velocity.
 */
static void write_isotropic(const struct Writer *writer, const struct RobotJoint *joint, const char *prefix,
                            double share, const char *square, bool is_turning) {
  const char *name = joint->symbol, *factor = number(share);
  const char *how = is_turning ? "about any axis" : "in any direction";
  if (joint->armature > 0) {
    char *parameter = format_text("%s_%sarmature", name, prefix);
    write_parameter(writer, parameter, joint->armature, is_turning ? "kg.m2" : "kg",
                    format_text("inertia of %s %s", name, how));
    set_content(write_element(writer, "kinetic", NULL), format_text("%s*%s*%s", factor, parameter, square));
  }
  if (joint->damping > 0) {
    char *parameter = format_text("%s_%sdamping", name, prefix);
    write_parameter(writer, parameter, joint->damping, is_turning ? "N.m.s/rad" : "N.s/m",
                    format_text("viscous damping of %s %s", name, how));
    set_content(write_element(writer, "dissipation", NULL), format_text("%s*%s*%s", factor, parameter, square));
  }
}

/* For unit quaternions |omega|^2 = 4 |dq/dt|^2. */
static void write_rotation_energy(const struct Writer *writer, const struct RobotJoint *joint, const char *prefix) {
  const char *name = joint->symbol;
  write_isotropic(writer, joint, prefix, 2,
                  format_text("(%s_qw_velocity^2 + %s_qx_velocity^2 + %s_qy_velocity^2 + %s_qz_velocity^2)", name, name,
                              name, name),
                  true);
}

/* Writes the friction of a free joint along the fixed axes, and about the axes of its body, as in MuJoCo. */
static void write_free_friction(const struct Writer *writer, const struct RobotJoint *joint) {
  static const char *const turns[3] = {"omegaX", "omegaY", "omegaZ"};
  const char *name = joint->symbol, *link = joint->child->symbol;
  write_parameter(writer, format_text("%s_friction", name), joint->friction, "N",
                  format_text("Coulomb friction of %s", name));
  write_parameter(writer, format_text("%s_turning_friction", name), joint->friction, "N.m",
                  format_text("Coulomb friction of %s", name));
  xmlNodePtr force = writer->options->sticks ? NULL : write_element(writer, "force", NULL);
  xmlNodePtr torque = writer->options->sticks ? NULL : write_element(writer, "torque", NULL);
  for (int i = 0; i < 6; i++) {
    bool is_turn = i >= 3;
    char *limit = format_text("%s_%sfriction", name, is_turn ? "turning_" : "");
    char *velocity =
        is_turn ? format_text("%s_body.%s", link, turns[i - 3]) : format_text("%s_%s_velocity", name, axes[i]);
    if (writer->options->sticks) {
      write_element(writer, "friction", "name",
                    format_text("%s_bearing_%s%s", name, is_turn ? "about_" : "", axes[i % 3]), "velocity", velocity,
                    "force", limit, NULL);
    } else
      set_attribute(is_turn ? torque : force, axes[i % 3],
                    format_text("-%s*tanh(%s/%s)", limit, velocity, is_turn ? "creep_rate" : "creep_velocity"));
  }
  if (writer->options->sticks) return;
  set_attribute(force, "on", link);
  set_attribute(torque, "on", link);
  set_attribute(torque, "in", link);
}

static void write_free(const struct Writer *writer, const struct RobotJoint *joint, const struct JointStart *start,
                       const char *description) {
  const char *name = joint->symbol;
  write_free_coordinates(writer, name, start, description);
  write_isotropic(writer, joint, "", 0.5,
                  format_text("(%s_x_velocity^2 + %s_y_velocity^2 + %s_z_velocity^2)", name, name, name), false);
  write_rotation_energy(writer, joint, "turning_");
  if (joint->friction > 0) write_free_friction(writer, joint);
}

/*
 * Limits the angle of a rotation. The vector part of its quaternion has the length sin(angle/2). The gap is a difference
 * of squares, which is smooth where the joint is not rotated.
 */
static void write_cone(const struct Writer *writer, const struct RobotJoint *joint) {
  if (isnan(joint->upper) || joint->upper >= M_PI) return;
  const char *name = joint->symbol, *largest = number(joint->upper), *square = number(pow(sin(joint->upper / 2), 2));
  char *rotated = format_text("(%s_qx^2 + %s_qy^2 + %s_qz^2)", name, name, name);
  if (writer->options->has_stops)
    write_element(writer, "contact", "name", format_text("%s_max", name), "unit", "1", "gap",
                  format_text("%s - %s", square, rotated), NULL);
  else
    write_output(
        writer, format_text("%s_beyond", name), "rad",
        format_text("if(%s > %s, 2*atan2(sqrt%s, abs(%s_qw)) - %s, 0)", rotated, square, rotated, name, largest),
        format_text("angle of %s less its limit, %s, where it is beyond it", name, largest));
}

static void write_ball(const struct Writer *writer, const struct RobotJoint *joint, const struct JointStart *start,
                       const char *description) {
  write_components(writer, joint->symbol, 3, start, description);
  write_rotation_energy(writer, joint, "");
  write_cone(writer, joint);
}

/* The inputs of a prescribed motion: a position, and rotations about fixed axes in the order x, y, z. */
static const char *const prescribed[6] = {"x", "y", "z", "roll", "pitch", "yaw"};

static void write_prescribed(const struct Writer *writer, const struct RobotJoint *joint) {
  for (int i = 0; i < 6; i++) {
    xmlNodePtr input = write_element(writer, "input", "name", format_text("%s_%s", joint->symbol, prescribed[i]),
                                     "unit", i < 3 ? "m" : "rad", "derivatives", "2", NULL);
    set_number(input, "start", joint->start.position[i]);
    set_attribute(input, "description", format_text("%s of the body '%s'", prescribed[i], joint->child->name));
  }
}

static void write_prescribed_motion(const struct Writer *writer, xmlNodePtr frame, const struct RobotJoint *joint) {
  xmlNodePtr translation = write_element_in(writer, frame, "translate");
  for (int i = 0; i < 3; i++) set_attribute(translation, axes[i], format_text("%s_%s", joint->symbol, prescribed[i]));
  for (int i = 2; i >= 0; i--) {
    xmlNodePtr rotation = write_element_in(writer, frame, "rotate");
    set_attribute(rotation, "axis", axes[i]);
    set_attribute(rotation, "angle", format_text("%s_%s", joint->symbol, prescribed[3 + i]));
  }
}

void write_joint(const struct Writer *writer, const struct RobotJoint *joint) {
  char *description = format_text("%s joint '%s' between '%s' and '%s'", joint_types[joint->type], joint->name,
                                  joint->parent->name, joint->child->name);
  struct JointStart start = start_of_quaternion(joint);
  if (joint_is_single(joint)) write_single(writer, joint, description);
  else if (joint->type == PLANAR) write_planar(writer, joint, description);
  else if (joint->type == FLOATING) write_free(writer, joint, &start, description);
  else if (joint->type == BALL) write_ball(writer, joint, &start, description);
  else if (joint->type == PRESCRIBED) write_prescribed(writer, joint);
}

/* Writes a rotation about an axis: x, y or z if possible, which needs fewer operations. */
static void write_rotation(const struct Writer *writer, xmlNodePtr frame, const double axis[3], const char *angle) {
  xmlNodePtr rotation = write_element_in(writer, frame, "rotate");
  int along = 0;
  while (along < 3 && fabs(axis[along]) != 1) along++;
  if (along < 3) {
    set_attribute(rotation, "axis", axes[along]);
    set_attribute(rotation, "angle", term(axis[along], angle));
    return;
  }
  char *text[3];
  for (int i = 0; i < 3; i++) text[i] = number(axis[i]);
  set_attribute(rotation, "axis", format_text("%s %s %s", text[0], text[1], text[2]));
  set_attribute(rotation, "angle", angle);
}

static void write_slide(const struct Writer *writer, xmlNodePtr frame, const double axis[3], const char *length) {
  xmlNodePtr translation = write_element_in(writer, frame, "translate");
  for (int i = 0; i < 3; i++)
    if (axis[i] != 0) set_attribute(translation, axes[i], term(axis[i], length));
}

/*
 * Sets two unit vectors perpendicular to the axis and to each other: x and y for z, y and z for x, z and x for y. For
 * other axes, the first vector is the projection of that for the nearest of these.
 */
static void axes_across(const double axis[3], double first[3], double second[3]) {
  int nearest = 0;
  for (int i = 1; i < 3; i++)
    if (fabs(axis[i]) > fabs(axis[nearest])) nearest = i;
  int next = (nearest + 1) % 3;
  double length = sqrt(1 - axis[next] * axis[next]);
  for (int i = 0; i < 3; i++) first[i] = ((i == next) - axis[next] * axis[i]) / length;
  for (int i = 0; i < 3; i++)
    second[i] = axis[(i + 1) % 3] * first[(i + 2) % 3] - axis[(i + 2) % 3] * first[(i + 1) % 3];
}

static void write_planar_motion(const struct Writer *writer, xmlNodePtr frame, const struct RobotJoint *joint) {
  double across[2][3];
  axes_across(joint->axis, across[0], across[1]);
  for (int i = 0; i < 2; i++) write_slide(writer, frame, across[i], format_text("%s_%s", joint->symbol, axes[i]));
  write_rotation(writer, frame, joint->axis, format_text("%s_angle", joint->symbol));
}

static void write_quaternion(const struct Writer *writer, xmlNodePtr frame, const char *name) {
  set_attribute(write_element_in(writer, frame, "rotate"), "quaternion",
                format_text("%s_qw %s_qx %s_qy %s_qz", name, name, name, name));
}

void write_free_motion(const struct Writer *writer, xmlNodePtr frame, const char *name) {
  xmlNodePtr translation = write_element_in(writer, frame, "translate");
  for (int i = 0; i < 3; i++) set_attribute(translation, axes[i], format_text("%s_%s", name, axes[i]));
  write_quaternion(writer, frame, name);
}

void write_motion(const struct Writer *writer, xmlNodePtr frame, const struct RobotJoint *joint) {
  if (joint->type == FLOATING) write_free_motion(writer, frame, joint->symbol);
  else if (joint->type == BALL) write_quaternion(writer, frame, joint->symbol);
  else if (joint->type == PLANAR) write_planar_motion(writer, frame, joint);
  else if (joint->type == PRESCRIBED) write_prescribed_motion(writer, frame, joint);
  else if (joint_is_single(joint)) {
    char *position = joint_position(joint);
    if (joint_slides(joint)) write_slide(writer, frame, joint->axis, position);
    else write_rotation(writer, frame, joint->axis, position);
  }
}
