#include "type_definitions.h"

#include <string.h>

#include "xml_output.h"

/* Prefix of type names, which must differ from names of variables. */
#define PREFIX "SI."

struct QuantityOfUnit {
  const char *unit, *type;
};

static const struct QuantityOfUnit quantities[] = {
    {"rad", PREFIX "Angle"},
    {"rad/s", PREFIX "AngularVelocity"},
    {"rad/s2", PREFIX "AngularAcceleration"},
    {"m", PREFIX "Length"},
    {"m/s", PREFIX "Velocity"},
    {"m/s2", PREFIX "Acceleration"},
    {"s", PREFIX "Time"},
    {"kg", PREFIX "Mass"},
    {"kg.m2", PREFIX "MomentOfInertia"},
    {"kg.m/s", PREFIX "Momentum"},
    {"kg.m2/s", PREFIX "AngularMomentum"},
    {"N", PREFIX "Force"},
    {"N.m", PREFIX "Torque"},
    {"N.s", PREFIX "Impulse"},
    {"J", PREFIX "Energy"},
    {"W", PREFIX "Power"},
    {"N/m", PREFIX "TranslationalSpringConstant"},
    {"N.s/m", PREFIX "TranslationalDampingConstant"},
    {"N.m/rad", PREFIX "RotationalSpringConstant"},
    {"N.m.s/rad", PREFIX "RotationalDampingConstant"},
};
enum { QUANTITY_COUNT = sizeof quantities / sizeof *quantities };

const char *declared_type(const struct InterfaceVariable *variable) {
  if (variable->unit == NULL || variable->entry.type != TYPE_REAL) return NULL;
  for (size_t i = 0; i < QUANTITY_COUNT; i++)
    if (strcmp(quantities[i].unit, variable->unit) == 0) return quantities[i].type;
  return NULL;
}

static void write_type(xmlTextWriterPtr writer, const struct QuantityOfUnit *quantity, const char *real) {
  bool is_nested = strcmp(real, "Real") == 0;
  if (is_nested) xmlTextWriterStartElement(writer, BAD_CAST "SimpleType");
  else xmlTextWriterStartElement(writer, BAD_CAST real);
  write_attribute(writer, "name", quantity->type);
  if (is_nested) xmlTextWriterStartElement(writer, BAD_CAST real);
  write_attribute(writer, "quantity", quantity->type + strlen(PREFIX));
  write_attribute(writer, "unit", quantity->unit);
  if (is_nested) xmlTextWriterEndElement(writer);
  xmlTextWriterEndElement(writer);
}

static bool is_used(const struct Interface *interface, size_t variable_count, const char *type) {
  for (size_t i = 0; i < variable_count; i++)
    if (declared_type(&interface->variables[i]) == type) return true;
  return false;
}

void write_types(xmlTextWriterPtr writer, const struct Interface *interface, size_t variable_count, const char *real) {
  bool is_open = false;
  for (size_t i = 0; i < QUANTITY_COUNT; i++) {
    if (!is_used(interface, variable_count, quantities[i].type)) continue;
    if (!is_open) xmlTextWriterStartElement(writer, BAD_CAST "TypeDefinitions");
    is_open = true;
    write_type(writer, &quantities[i], real);
  }
  if (is_open) xmlTextWriterEndElement(writer);
}
