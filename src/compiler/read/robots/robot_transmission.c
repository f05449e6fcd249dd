#include "read/robots/robot_transmission.h"

#include <math.h>

#include "base/memory.h"
#include "read/robots/robot_joint.h"
#include "read/robots/robot_tree.h"

static char *coefficient_of(const struct TransmissionTerm *term) {
  return term->symbol != NULL ? copy_text(term->symbol) : number(term->coefficient);
}

/* Returns the derivative of the transmission's length with respect to the coordinate of the joint's leader. */
static char *share_of(const struct TransmissionTerm *term) {
  const struct RobotJoint *joint = term->joint;
  char *ratio = joint->leader != joint ? joint_ratio(joint) : number(1);
  return term->coefficient == 1 && term->symbol == NULL ? ratio : format_text("%s*%s", coefficient_of(term), ratio);
}

static bool is_joint(const struct Transmission *transmission) {
  return transmission->count == 1 && transmission->terms->coefficient == 1;
}

static char *length_through_space(const struct Transmission *transmission) {
  char *sum = copy_text("");
  for (size_t i = 1; i < transmission->site_count; i++)
    sum = format_text("%s%sdistance(%s, %s)", sum, i > 1 ? " + " : "", transmission->sites[i - 1]->symbol,
                      transmission->sites[i]->symbol);
  return format_text("(%s)", sum);
}

bool transmission_slides(const struct Transmission *transmission) {
  return transmission->site_count > 0 || joint_slides(transmission->terms->joint);
}

const char *transmission_unit(const struct Transmission *transmission) {
  return transmission_slides(transmission) ? "m" : "rad";
}

char *transmission_length(const struct Transmission *transmission) {
  if (transmission->site_count > 0) return length_through_space(transmission);
  if (is_joint(transmission)) return joint_position(transmission->terms->joint);
  char *sum = copy_text("");
  for (size_t i = 0; i < transmission->count; i++)
    sum = format_text("%s%s%s*%s", sum, i > 0 ? " + " : "", coefficient_of(&transmission->terms[i]),
                      joint_position(transmission->terms[i].joint));
  return format_text("(%s)", sum);
}

char *transmission_rate(const struct Transmission *transmission) {
  if (transmission->site_count > 0) return format_text("der%s", length_through_space(transmission));
  char *sum = copy_text("");
  for (size_t i = 0; i < transmission->count; i++)
    sum = format_text("%s%s%s*%s_velocity", sum, i > 0 ? " + " : "", share_of(&transmission->terms[i]),
                      transmission->terms[i].joint->leader->symbol);
  return is_joint(transmission) ? sum : format_text("(%s)", sum);
}

/* Writes a force on one end of a segment, directed away from the other end. */
static void write_site_force(const struct Writer *writer, const struct RobotLink *end, const struct RobotLink *other,
                             const char *force) {
  static const char *const axes[] = {"x", "y", "z"};
  xmlNodePtr node = write_element(writer, "force");
  set_attribute(node, "on", copy_text(end->symbol));
  for (int i = 0; i < 3; i++)
    set_attribute(node, axes[i],
                  format_text("%s*(%s.%s - %s.%s)/distance(%s, %s)", force, end->symbol, axes[i], other->symbol,
                              axes[i], end->symbol, other->symbol));
}

static void write_forces(const struct Writer *writer, const struct Transmission *transmission, const char *force) {
  for (size_t i = 1; i < transmission->site_count; i++) {
    const struct RobotLink *first = transmission->sites[i - 1], *second = transmission->sites[i];
    if (first->carrier == second->carrier) continue; /* the segment has a constant length */
    write_site_force(writer, first, second, force);
    write_site_force(writer, second, first, force);
  }
}

static void write_joint_force(const struct Writer *writer, const struct RobotJoint *joint, char *force) {
  xmlNodePtr node = write_element(writer, "force");
  set_attribute(node, "coordinate", copy_text(joint->leader->symbol));
  set_content(node, force);
}

/* Adds an actuator's force to the sum for a joint that limits it, see write_limited_forces(). */
static void add_push(struct RobotJoint *joint, char *actuator_limits) {
  joint->actuator_forces = joint->actuator_forces == NULL
                               ? actuator_limits
                               : format_text("%s + %s", joint->actuator_forces, actuator_limits);
}

void write_term(const struct Writer *writer, const struct Transmission *transmission, const char *gear,
                const char *name, char *force, bool is_of_actuator) {
  if (transmission->count > 1 || transmission->site_count > 0) {
    xmlNodePtr definition = write_element(writer, "define");
    set_attribute(definition, "name", format_text("%s_force", name));
    set_content(definition, force);
    force = format_text("%s_force", name);
  }
  write_forces(writer, transmission, format_text("%s*%s", gear, force));
  for (size_t i = 0; i < transmission->count; i++) {
    const struct TransmissionTerm *term = &transmission->terms[i];
    if (is_of_actuator && !isnan(term->joint->actuator_limits[0]))
      add_push(term->joint, format_text("%s*%s*(%s)", gear, coefficient_of(term), force));
    else write_joint_force(writer, term->joint, format_text("%s*%s*(%s)", gear, share_of(term), force));
  }
}

void write_limited_forces(const struct Writer *writer, const struct RobotJoint *joint) {
  if (joint->actuator_forces == NULL) return;
  char *ratio = joint->leader != joint ? joint_ratio(joint) : number(1);
  write_joint_force(writer, joint,
                    format_text("%s*%s", ratio, clamped(joint->actuator_limits, joint->actuator_forces)));
}

/*
 * The control of a servo is a position, if gain = -bias[1], or a velocity, if gain = -bias[2] without a spring. Any
 * other control is a force or scales one.
 */
void write_actuator(const struct Writer *writer, const struct Actuator *actuator) {
  const struct Transmission *transmission = &actuator->transmission;
  bool slides = transmission_slides(transmission), has_spring = actuator->bias[1] != 0,
       has_damper = actuator->bias[2] != 0;
  bool is_servo = has_spring && actuator->gain == -actuator->bias[1];
  bool is_prescribed_motion = !has_spring && has_damper && actuator->gain == -actuator->bias[2];
  const char *length = transmission_length(transmission), *rate = transmission_rate(transmission);
  char *name = format_text("%s_control", robot_symbol(actuator->name)), *gear = number(actuator->gear);
  char *control = clamped(actuator->control, name), *gain = number(actuator->gain);
  char *force = is_servo               ? format_text("%s_stiffness*%s", name, control)
                : is_prescribed_motion ? format_text("%s_damping*%s", name, control)
                                       : format_text("%s*%s", gain, control);
  const char *unit = slides ? "N" : "N.m";
  if (has_spring) {
    write_parameter(writer, format_text("%s_stiffness", name), -actuator->bias[1], slides ? "N/m" : "N.m/rad",
                    format_text("force of the actuator '%s' by position", actuator->name));
    force = format_text("%s - %s_stiffness*(%s*%s)", force, name, gear, length);
  }
  if (has_damper) {
    write_parameter(writer, format_text("%s_damping", name), -actuator->bias[2], slides ? "N.s/m" : "N.m.s/rad",
                    format_text("force of the actuator '%s' by velocity", actuator->name));
    force = format_text("%s - %s_damping*(%s*%s)", force, name, gear, rate);
  }
  if (actuator->bias[0] != 0) {
    write_parameter(writer, format_text("%s_bias", name), actuator->bias[0], unit,
                    format_text("constant force of the actuator '%s'", actuator->name));
    force = format_text("%s + %s_bias", force, name);
  }
  xmlNodePtr input = write_element(writer, "input");
  if (is_servo) unit = slides ? "m" : "rad";
  if (is_prescribed_motion) unit = slides ? "m/s" : "rad/s";
  set_attribute(input, "name", name);
  set_attribute(input, "unit", copy_text(unit));
  set_number(input, "start", actuator->start);
  set_attribute(input, "description", format_text("control of the actuator '%s'", actuator->name));
  write_term(writer, transmission, gear, name, clamped(actuator->force, force), true);
}
