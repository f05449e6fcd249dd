#include "robots/robot_elements.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <string.h>

#include "algebra/formula.h"
#include "base/memory.h"
#include "model/kinematics.h"
#include "xml/lines.h"

xmlNodePtr write_element_in(const struct Writer *writer, xmlNodePtr parent, const char *name) {
  xmlNodePtr node = xmlNewChild(parent, NULL, (const xmlChar *)name, NULL);
  set_line(node, writer->line);
  return node;
}

xmlNodePtr write_element(const struct Writer *writer, const char *name, ...) {
  xmlNodePtr node = write_element_in(writer, writer->system, name);
  va_list pairs;
  va_start(pairs, name);
  for (const char *attribute = va_arg(pairs, const char *); attribute != NULL; attribute = va_arg(pairs, const char *))
    set_attribute(node, attribute, va_arg(pairs, const char *));
  va_end(pairs);
  return node;
}

void set_attribute(xmlNodePtr node, const char *attribute, const char *value) {
  xmlNewProp(node, (const xmlChar *)attribute, (const xmlChar *)value);
}

void set_content(xmlNodePtr node, const char *text) {
  xmlNodeAddContent(node, (const xmlChar *)text);
}

void set_number(xmlNodePtr node, const char *attribute, double value) {
  if (value != 0) set_attribute(node, attribute, number(value));
}

xmlNodePtr write_parameter(const struct Writer *writer, const char *name, double value, const char *unit,
                           const char *description) {
  return write_element(writer, "parameter", "name", name, "start", number(value), "unit", unit, "description",
                       description, NULL);
}

void write_output(const struct Writer *writer, const char *name, const char *unit, const char *expression,
                  const char *description) {
  set_content(write_element(writer, "output", "name", name, "unit", unit, "description", description, NULL),
              expression);
}

xmlNodePtr write_coordinate(const struct Writer *writer, const char *name, const char *unit, const char *description) {
  return write_element(writer, "coordinate", "name", name, "velocity", format_text("%s_velocity", name), "unit", unit,
                       "description", description, NULL);
}

xmlNodePtr write_motor(const struct Writer *writer, const char *name, const char *unit, double effort,
                       const char *description) {
  bool is_length = strcmp(unit, "m") == 0;
  const char *kind = is_length ? "force" : "torque", *unit_of_effort = is_length ? "N" : "N.m";
  const char *direction = format_text("%s %s", is_length ? "along" : "about", name);
  xmlNodePtr coordinate = write_coordinate(writer, name, unit, description);
  char *wanted = format_text("%s_%s", name, kind);
  if (!isnan(effort))
    set_attribute(write_parameter(writer, format_text("%s_effort", name), effort, unit_of_effort,
                                  format_text("largest %s %s", kind, direction)),
                  "min", number(0));
  write_element(writer, "input", "name", wanted, "unit", unit_of_effort, "description",
                format_text("%s %s", kind, direction), NULL);
  set_content(write_element(writer, "force", "coordinate", name, NULL),
              isnan(effort) ? wanted : format_text("max(-%s_effort, min(%s_effort, %s))", name, name, wanted));
  return coordinate;
}

void write_excess_of_limits(const struct Writer *writer, const char *name, const char *unit, const char *lower,
                            const char *upper) {
  write_output(writer, format_text("%s_beyond", name), unit,
               format_text("max(0, %s - (%s)) + min(0, %s - (%s))", name, upper, name, lower),
               format_text("%s less its limits, %s and %s, where it is beyond them", name, lower, upper));
}

void write_end_contacts(const struct Writer *writer, const char *name, const char *unit, const char *position,
                        const char *lower, const char *upper) {
  for (int end = 0; end < 2; end++) {
    write_element(writer, "contact", "name", format_text("%s_%s", name, end == 0 ? "min" : "max"), "unit", unit, "gap",
                  end == 0 ? format_text("%s - (%s)", position, lower) : format_text("%s - %s", upper, position), NULL);
  }
}

void write_placement(const struct Writer *writer, xmlNodePtr frame, const struct Placement *placement) {
  const double *shift = placement->translation;
  double angles[3];
  placement_angles(placement, angles);
  xmlNodePtr translation =
      shift[0] != 0 || shift[1] != 0 || shift[2] != 0 ? write_element_in(writer, frame, "translate") : NULL;
  for (int i = 0; i < 3 && translation != NULL; i++) set_number(translation, axes[i], shift[i]);
  for (int i = 2; i >= 0; i--) {
    if (angles[i] == 0) continue;
    xmlNodePtr rotation = write_element_in(writer, frame, "rotate");
    set_attribute(rotation, "axis", axes[i]);
    set_number(rotation, "angle", angles[i]);
  }
}

char *number(double value) {
  char text[NUMBER_LENGTH];
  number_text(value, text);
  return copy_text(text);
}

char *clamped(const double limits[2], char *expression) {
  if (isnan(limits[0])) return expression;
  char *lower = number(limits[0]), *upper = number(limits[1]);
  return format_text("max(%s, min(%s, %s))", lower, upper, expression);
}

char *term(double factor, const char *name) {
  if (factor == 1) return copy_text(name);
  if (factor == -1) return format_text("-%s", name);
  char *text = number(factor), *product = format_text("%s*%s", text, name);
  return product;
}
