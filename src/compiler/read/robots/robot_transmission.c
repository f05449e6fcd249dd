#include "read/robots/robot_transmission.h"

#include <math.h>

#include "base/memory.h"
#include "read/robots/robot_joint.h"
#include "read/robots/robot_tree.h"

static char *coefficient_of(const struct Pull *pull) {
  return pull->symbol != NULL ? copy_text(pull->symbol) : number(pull->coefficient);
}

/* What the velocity of the coordinate behind the joint is multiplied by. */
static char *share_of(const struct Pull *pull) {
  const struct Joint *joint = pull->joint;
  char *ratio = joint->leader != joint ? joint_ratio(joint) : number(1);
  return pull->coefficient == 1 && pull->symbol == NULL ? ratio : format_text("%s*%s", coefficient_of(pull), ratio);
}

static bool is_joint(const struct Transmission *transmission) {
  return transmission->count == 1 && transmission->pulls->coefficient == 1;
}

static char *length_of(const struct Transmission *transmission) {
  if (is_joint(transmission)) return joint_position(transmission->pulls->joint);
  char *sum = copy_text("");
  for (size_t i = 0; i < transmission->count; i++)
    sum = format_text("%s%s%s*%s", sum, i > 0 ? " + " : "", coefficient_of(&transmission->pulls[i]),
                      joint_position(transmission->pulls[i].joint));
  return format_text("(%s)", sum);
}

static char *rate_of(const struct Transmission *transmission) {
  char *sum = copy_text("");
  for (size_t i = 0; i < transmission->count; i++)
    sum = format_text("%s%s%s*%s_velocity", sum, i > 0 ? " + " : "", share_of(&transmission->pulls[i]),
                      transmission->pulls[i].joint->leader->symbol);
  return is_joint(transmission) ? sum : format_text("(%s)", sum);
}

/* The forces on the joints of one along the transmission, which has a name of its own where several rest on it. */
static void write_pull(const struct Writer *writer, const struct Transmission *transmission, const char *gear,
                       const char *name, char *force) {
  if (transmission->count > 1) {
    xmlNodePtr definition = write_element(writer, "define");
    set_attribute(definition, "name", format_text("%s_force", name));
    set_content(definition, force);
    force = format_text("%s_force", name);
  }
  for (size_t i = 0; i < transmission->count; i++) {
    const struct Pull *pull = &transmission->pulls[i];
    xmlNodePtr node = write_element(writer, "force");
    set_attribute(node, "coordinate", copy_text(pull->joint->leader->symbol));
    set_content(node, format_text("%s*%s*(%s)", gear, share_of(pull), force));
  }
}

/* A control that a spring follows is a position, one that a damper follows a velocity; any other is the force itself, or scales it. */
void write_actuator(const struct Writer *writer, const struct Actuator *actuator) {
  const struct Transmission *transmission = &actuator->transmission;
  bool slides = joint_slides(transmission->pulls->joint), has_spring = actuator->bias[1] != 0,
       has_damper = actuator->bias[2] != 0;
  bool is_servo = has_spring && actuator->gain == -actuator->bias[1];
  bool is_drive = !has_spring && has_damper && actuator->gain == -actuator->bias[2];
  const char *length = length_of(transmission), *rate = rate_of(transmission);
  char *name = format_text("%s_control", robot_symbol(actuator->name)), *gear = number(actuator->gear);
  char *control = clamped(actuator->control, name), *gain = number(actuator->gain);
  char *force = is_servo   ? format_text("%s_stiffness*%s", name, control)
                : is_drive ? format_text("%s_damping*%s", name, control)
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
  if (is_drive) unit = slides ? "m/s" : "rad/s";
  set_attribute(input, "name", name);
  set_attribute(input, "unit", copy_text(unit));
  set_number(input, "start", actuator->start);
  set_attribute(input, "description", format_text("control of the actuator '%s'", actuator->name));
  write_pull(writer, transmission, gear, name, clamped(actuator->force, force));
}

static void write_coefficients(const struct Writer *writer, const struct Tendon *tendon) {
  for (size_t i = 0; i < tendon->transmission.count; i++) {
    const struct Pull *pull = &tendon->transmission.pulls[i];
    if (pull->symbol == NULL) continue;
    write_parameter(writer, copy_text(pull->symbol), pull->coefficient, joint_slides(pull->joint) ? "rad/m" : "m/rad",
                    format_text("by how much the tendon '%s' follows the joint '%s'", tendon->name, pull->joint->name));
  }
}

static void write_spring(const struct Writer *writer, const struct Tendon *tendon, bool slides) {
  const char *name = tendon->symbol, *lower = number(tendon->relaxed[0]), *upper = number(tendon->relaxed[1]);
  write_parameter(writer, format_text("%s_stiffness", name), tendon->stiffness, slides ? "N/m" : "N.m/rad",
                  format_text("stiffness of the tendon '%s'", tendon->name));
  set_content(
      write_element(writer, "potential"),
      tendon->relaxed[0] == tendon->relaxed[1]
          ? format_text("%s_stiffness*(%s - (%s))^2/2", name, name, lower)
          : format_text("%s_stiffness*(max(0, %s - (%s))^2 + min(0, %s - (%s))^2)/2", name, name, upper, name, lower));
}

void write_tendon(const struct Writer *writer, const struct Tendon *tendon) {
  const struct Transmission *transmission = &tendon->transmission;
  const char *name = tendon->symbol, *unit = joint_unit(transmission->pulls->joint);
  bool slides = joint_slides(transmission->pulls->joint);
  write_coefficients(writer, tendon);
  write_output(writer, copy_text(name), unit, length_of(transmission),
               format_text("length of the tendon '%s'", tendon->name));
  if (tendon->armature > 0) {
    write_parameter(writer, format_text("%s_armature", name), tendon->armature, slides ? "kg" : "kg.m2",
                    format_text("inertia along the tendon '%s'", tendon->name));
    set_content(write_element(writer, "kinetic"), format_text("%s_armature*%s^2/2", name, rate_of(transmission)));
  }
  if (tendon->stiffness > 0) write_spring(writer, tendon, slides);
  if (tendon->damping > 0) {
    write_parameter(writer, format_text("%s_damping", name), tendon->damping, slides ? "N.s/m" : "N.m.s/rad",
                    format_text("viscous damping of the tendon '%s'", tendon->name));
    set_content(write_element(writer, "dissipation"), format_text("%s_damping*%s^2/2", name, rate_of(transmission)));
  }
  if (isnan(tendon->lower)) return;
  const char *lower = number(tendon->lower), *upper = number(tendon->upper);
  if (writer->options->has_stops) write_end_contacts(writer, name, unit, name, lower, upper);
  else write_beyond(writer, name, unit, lower, upper);
}
