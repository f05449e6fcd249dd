#include "robots/robot_transmission.h"

#include <math.h>

#include "base/memory.h"
#include "model/kinematics.h"
#include "robots/robot_joint.h"
#include "robots/robot_tree.h"

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
  xmlNodePtr node = write_element(writer, "force", "on", end->symbol, NULL);
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
  set_content(write_element(writer, "force", "coordinate", joint->leader->symbol, NULL), force);
}

/* Adds an actuator's force to the sum for a joint that limits it, see write_limited_forces(). */
static void add_actuator_force(struct RobotJoint *joint, char *force) {
  joint->actuator_forces =
      joint->actuator_forces == NULL ? force : format_text("%s + %s", joint->actuator_forces, force);
}

void write_term(const struct Writer *writer, const struct Transmission *transmission, const char *gear,
                const char *name, char *force, bool is_of_actuator) {
  if (transmission->count > 1 || transmission->site_count > 0) {
    set_content(write_element(writer, "define", "name", format_text("%s_force", name), NULL), force);
    force = format_text("%s_force", name);
  }
  write_forces(writer, transmission, format_text("%s*%s", gear, force));
  for (size_t i = 0; i < transmission->count; i++) {
    const struct TransmissionTerm *term = &transmission->terms[i];
    if (is_of_actuator && !isnan(term->joint->actuator_limits[0]))
      add_actuator_force(term->joint, format_text("%s*%s*(%s)", gear, coefficient_of(term), force));
    else write_joint_force(writer, term->joint, format_text("%s*%s*(%s)", gear, share_of(term), force));
  }
}

void write_limited_forces(const struct Writer *writer, const struct RobotJoint *joint) {
  if (joint->actuator_forces == NULL) return;
  char *ratio = joint->leader != joint ? joint_ratio(joint) : number(1);
  write_joint_force(writer, joint,
                    format_text("%s*%s", ratio, clamped(joint->actuator_limits, joint->actuator_forces)));
}

/* Expressions of an actuator: its control or activation, length and rate times the gear. */
struct ActuatorTerms {
  char *name, *control, *length, *rate;
  bool slides;
};

/*
 * Writes the state of a filter or integrator, whose activation replaces the control. It stays where it would pass its
 * limits, as MuJoCo clips it. unit: of the activation.
 */
static char *write_activation(const struct Writer *writer, const struct Actuator *actuator, const char *name,
                              char *control, const char *unit) {
  char *state = format_text("%s_activation", name), *rate = control;
  if (actuator->dynamics == FILTER) {
    char *time = format_text("%s_time", name);
    write_parameter(writer, time, actuator->time_constant, "s",
                    format_text("time constant of the actuator '%s'", actuator->name));
    rate = format_text("(%s - %s)/%s", control, state, time);
  }
  xmlNodePtr node = write_element(writer, "state", "name", state, "unit", unit, NULL);
  set_number(node, "start", actuator->start_activation);
  const char *driven = actuator->dynamics == FILTER ? format_text("%s - %s", control, state) : control;
  char *lower = number(actuator->activation[0]), *upper = number(actuator->activation[1]);
  if (!isnan(actuator->activation[0]))
    rate = format_text("if((%s > %s or %s > 0) and (%s < %s or 0 > %s), %s, 0)", state, lower, driven, state, upper,
                       driven, rate);
  set_attribute(node, "rate", rate);
  set_attribute(node, "description", format_text("activation of the actuator '%s'", actuator->name));
  return clamped(actuator->activation, state);
}

/* Returns the product of the control with the gain by position and velocity, for which it writes parameters. */
static char *variable_gain(const struct Writer *writer, const struct Actuator *actuator,
                           const struct ActuatorTerms *terms) {
  static const char *const by[2] = {"position", "velocity"};
  static const char *const units[2][2][2] = {{{"N.m/rad", "N.m.s/rad"}, {"N/m", "N.s/m"}},
                                             {{"1/rad", "s/rad"}, {"1/m", "s/m"}}};
  bool is_scaled = actuator->gain[0] != 0;
  char *gain = is_scaled ? number(actuator->gain[0]) : copy_text("");
  for (int i = 0; i < 2; i++) {
    if (actuator->gain[i + 1] == 0) continue;
    char *parameter = format_text("%s_gain_by_%s", terms->name, by[i]);
    write_parameter(writer, parameter, actuator->gain[i + 1], units[is_scaled][terms->slides][i],
                    format_text("gain of the actuator '%s' by %s", actuator->name, by[i]));
    gain = format_text("%s%s%s*%s", gain, *gain != '\0' ? " + " : "", parameter, i == 0 ? terms->length : terms->rate);
  }
  return format_text("(%s)*%s", gain, terms->control);
}

/* Adds the bias to the force, with parameters. */
static char *with_bias(const struct Writer *writer, const struct Actuator *actuator, const struct ActuatorTerms *terms,
                       char *force) {
  const char *name = terms->name;
  bool slides = terms->slides;
  if (actuator->bias[1] != 0) {
    write_parameter(writer, format_text("%s_stiffness", name), -actuator->bias[1], slides ? "N/m" : "N.m/rad",
                    format_text("force of the actuator '%s' by position", actuator->name));
    force = format_text("%s - %s_stiffness*%s", force, name, terms->length);
  }
  if (actuator->bias[2] != 0) {
    write_parameter(writer, format_text("%s_damping", name), -actuator->bias[2], slides ? "N.s/m" : "N.m.s/rad",
                    format_text("force of the actuator '%s' by velocity", actuator->name));
    force = format_text("%s - %s_damping*%s", force, name, terms->rate);
  }
  if (actuator->bias[0] == 0) return force;
  write_parameter(writer, format_text("%s_bias", name), actuator->bias[0], slides ? "N" : "N.m",
                  format_text("constant force of the actuator '%s'", actuator->name));
  return format_text("%s + %s_bias", force, name);
}

static bool has_force(const struct Wrench *wrench) {
  return wrench->force[0] != 0 || wrench->force[1] != 0 || wrench->force[2] != 0;
}

/* Writes a <force> or <torque> of these components on a link, reversed if the sign is -1. frame: NULL for the base. */
static void write_load(const struct Writer *writer, const char *kind, const struct RobotLink *link,
                       const struct RobotLink *frame, int sign, char *const components[3]) {
  if (link == NULL || !carrier_moves(link, writer->options->floats)) return;
  if (components[0] == NULL && components[1] == NULL && components[2] == NULL) return;
  xmlNodePtr node = write_element(writer, kind, "on", link->symbol, NULL);
  if (frame != NULL) set_attribute(node, "in", frame->symbol);
  for (int i = 0; i < 3; i++)
    if (components[i] != NULL) set_attribute(node, axes[i], format_text("%s%s", sign < 0 ? "-" : "", components[i]));
}

/* Writes the force and torque. Beside a force, the torque by force is a parameter, as it is a length. */
static void write_wrench(const struct Writer *writer, const struct Wrench *wrench, const char *name, char *force) {
  char *forces[3] = {NULL}, *torques[3] = {NULL};
  set_content(write_element(writer, "define", "name", format_text("%s_force", name), NULL), force);
  for (int i = 0; i < 3; i++) {
    if (wrench->force[i] != 0) forces[i] = format_text("%s*%s_force", number(wrench->force[i]), name);
    if (wrench->torque[i] == 0) continue;
    char *factor = number(wrench->torque[i]);
    if (has_force(wrench)) {
      factor = format_text("%s_torque_%s", name, axes[i]);
      write_parameter(writer, factor, wrench->torque[i], "m", format_text("torque about %s by force", axes[i]));
    }
    torques[i] = format_text("%s*%s_force", factor, name);
  }
  struct RobotLink *const *links = wrench->links;
  write_load(writer, "force", links[WRENCH_LINK], links[FORCE_AXES], 1, forces);
  write_load(writer, "torque", links[WRENCH_LINK], links[TORQUE_AXES], 1, torques);
  write_load(writer, "torque", links[WRENCH_SUPPORT], links[TORQUE_AXES], -1, torques);
}

/*
 * The control of a servo is a position, if gain = -bias[1], or a velocity, if gain = -bias[2] without a spring. The
 * control of a pure variable gain is a number. Any other control is a force or scales one. The control of an integrator
 * is the rate of this.
 */
void write_actuator(const struct Writer *writer, const struct Actuator *actuator) {
  const struct Transmission *transmission = &actuator->transmission;
  const struct Wrench *wrench = actuator->wrench;
  bool slides = wrench != NULL ? has_force(wrench) : transmission_slides(transmission),
       has_spring = actuator->bias[1] != 0, has_damper = actuator->bias[2] != 0,
       varies = actuator->gain[1] != 0 || actuator->gain[2] != 0;
  bool is_servo = !varies && has_spring && actuator->gain[0] == -actuator->bias[1];
  bool is_prescribed_motion = !varies && !has_spring && has_damper && actuator->gain[0] == -actuator->bias[2];
  char *name = format_text("%s_control", robot_symbol(actuator->name)), *gear = number(actuator->gear);
  const char *unit = is_servo                           ? slides ? "m" : "rad"
                     : is_prescribed_motion             ? slides ? "m/s" : "rad/s"
                     : varies && actuator->gain[0] == 0 ? "1"
                     : slides                           ? "N"
                                                        : "N.m";
  struct ActuatorTerms terms = {.name = name, .control = clamped(actuator->control, name), .slides = slides};
  if (wrench == NULL) {
    terms.length = format_text("(%s*%s)", gear, transmission_length(transmission));
    terms.rate = format_text("(%s*%s)", gear, transmission_rate(transmission));
  }
  xmlNodePtr input = write_element(writer, "input", "name", name, "unit",
                                   actuator->dynamics == INTEGRATOR ? format_text("%s.s-1", unit) : unit, NULL);
  set_number(input, "start", actuator->start);
  set_attribute(input, "description", format_text("control of the actuator '%s'", actuator->name));
  if (actuator->dynamics != WITHOUT_STATE)
    terms.control = write_activation(writer, actuator, name, terms.control, unit);
  char *force = is_servo               ? format_text("%s_stiffness*%s", name, terms.control)
                : is_prescribed_motion ? format_text("%s_damping*%s", name, terms.control)
                : varies               ? variable_gain(writer, actuator, &terms)
                                       : format_text("%s*%s", number(actuator->gain[0]), terms.control);
  force = with_bias(writer, actuator, &terms, force);
  force = clamped(actuator->force, force);
  if (wrench != NULL) write_wrench(writer, wrench, name, force);
  else write_term(writer, transmission, gear, name, force, true);
}
