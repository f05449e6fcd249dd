#include "robots/robot_tendon.h"

#include <math.h>

#include "base/memory.h"
#include "robots/robot_joint.h"
#include "robots/robot_transmission.h"
#include "robots/robot_tree.h"

static void write_coefficients(const struct Writer *writer, const struct Tendon *tendon) {
  for (size_t i = 0; i < tendon->transmission.count; i++) {
    const struct TransmissionTerm *term = &tendon->transmission.terms[i];
    if (term->symbol == NULL) continue;
    write_parameter(writer, term->symbol, term->coefficient, joint_slides(term->joint) ? "rad/m" : "m/rad",
                    format_text("coefficient in the tendon '%s' of the joint '%s'", tendon->name, term->joint->name));
  }
}

static void write_spring(const struct Writer *writer, const struct Tendon *tendon, bool slides) {
  const char *name = tendon->symbol, *lower = number(tendon->relaxed[0]), *upper = number(tendon->relaxed[1]);
  write_parameter(writer, format_text("%s_stiffness", name), tendon->stiffness, slides ? "N/m" : "N.m/rad",
                  format_text("stiffness of the tendon '%s'", tendon->name));
  set_content(
      write_element(writer, "potential", NULL),
      tendon->relaxed[0] == tendon->relaxed[1]
          ? format_text("%s_stiffness*(%s - (%s))^2/2", name, name, lower)
          : format_text("%s_stiffness*(max(0, %s - (%s))^2 + min(0, %s - (%s))^2)/2", name, name, upper, name, lower));
}

/* Writes the energy or dissipation parameter*rate^2/2. */
static void write_square(const struct Writer *writer, const struct Tendon *tendon, const char *element, double value,
                         const char *word, const char *unit, const char *meaning) {
  write_parameter(writer, format_text("%s_%s", tendon->symbol, word), value, unit,
                  format_text("%s the tendon '%s'", meaning, tendon->name));
  set_content(write_element(writer, element, NULL),
              format_text("%s_%s*%s^2/2", tendon->symbol, word, transmission_rate(&tendon->transmission)));
}

/* Writes the friction of a tendon, dry or regularized as that of joints. */
static void write_friction(const struct Writer *writer, const struct Tendon *tendon, bool slides) {
  const char *name = tendon->symbol, *creep = slides ? "creep_velocity" : "creep_rate";
  char *rate = transmission_rate(&tendon->transmission);
  write_parameter(writer, format_text("%s_friction", name), tendon->friction, slides ? "N" : "N.m",
                  format_text("Coulomb friction of the tendon '%s'", tendon->name));
  if (writer->options->sticks) {
    write_element(writer, "friction", "name", format_text("%s_sheath", name), "velocity", rate, "force",
                  format_text("%s_friction", name), NULL);
  } else
    write_term(writer, &tendon->transmission, number(1), format_text("%s_sheath", name),
               format_text("-%s_friction*tanh(%s/%s)", name, rate, creep), false);
}

void write_tendon(const struct Writer *writer, const struct Tendon *tendon) {
  const struct Transmission *transmission = &tendon->transmission;
  const char *name = tendon->symbol, *unit = transmission_unit(transmission);
  bool slides = transmission_slides(transmission);
  write_coefficients(writer, tendon);
  write_output(writer, name, unit, transmission_length(transmission),
               format_text("length of the tendon '%s'", tendon->name));
  if (tendon->armature > 0)
    write_square(writer, tendon, "kinetic", tendon->armature, "armature", slides ? "kg" : "kg.m2", "inertia along");
  if (tendon->stiffness > 0) write_spring(writer, tendon, slides);
  if (tendon->damping > 0)
    write_square(writer, tendon, "dissipation", tendon->damping, "damping", slides ? "N.s/m" : "N.m.s/rad",
                 "viscous damping of");
  if (tendon->friction > 0) write_friction(writer, tendon, slides);
  if (isnan(tendon->lower)) return;
  const char *lower = number(tendon->lower), *upper = number(tendon->upper);
  if (writer->options->has_stops) write_end_contacts(writer, name, unit, name, lower, upper);
  else write_excess_of_limits(writer, name, unit, lower, upper);
}

/* Returns the expression of a part's displacement from its start. */
static char *displacement_of(const struct CoupledPart *part) {
  return format_text("%s - (%s)", transmission_length(&part->transmission), number(part->start));
}

/* Writes the parameter for the coefficient of a power of the other part's displacement. Returns its name. */
static char *power_of(const struct Writer *writer, const struct Coupling *coupling, int power) {
  const struct CoupledPart *first = &coupling->parts[0], *second = &coupling->parts[1];
  const char *unit = transmission_unit(&first->transmission), *other = transmission_unit(&second->transmission);
  char *name = format_text("%s_by_power_%d", robot_symbol(coupling->name), power);
  write_parameter(writer, name, coupling->coefficient[power],
                  power > 1 ? format_text("%s/%s%d", unit, other, power) : format_text("%s/%s", unit, other),
                  format_text("coefficient in '%s' of '%s'", first->name, second->name));
  return name;
}

void write_coupling(const struct Writer *writer, const struct Coupling *coupling) {
  const struct CoupledPart *first = &coupling->parts[0], *second = &coupling->parts[1];
  char *residual = format_text("%s - (%s)", displacement_of(first), number(coupling->coefficient[0]));
  for (int power = 1; power < COUPLING_POWERS; power++)
    if (coupling->coefficient[power] != 0)
      residual =
          format_text("%s - %s*(%s)^%d", residual, power_of(writer, coupling, power), displacement_of(second), power);
  set_content(write_element(writer, "constraint", "name", robot_symbol(coupling->name), "unit",
                            transmission_unit(&first->transmission), NULL),
              residual);
}
