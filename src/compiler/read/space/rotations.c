#include "read/space/rotations.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "algebra/simplify.h"
#include "base/memory.h"
#include "names/definitions.h"

xmlNodePtr quaternion_of(xmlNodePtr frame) {
  for (xmlNodePtr step = frame->children; step != NULL; step = step->next)
    if (step->type == XML_ELEMENT_NODE && has_attribute(step, "quaternion")) return step;
  return NULL;
}

static const char blanks[] = " \t\r\n";

/* Parses `count` expressions, separated by blanks, in an attribute. */
static void read_expressions(struct Reader *reader, xmlNodePtr node, const char *name, unsigned kinds, size_t count,
                             Node *nodes) {
  char *text = attribute(node, name), *what = format_text("%s of <rotate>", name), *rest = NULL;
  struct Location location = {.line = line_of_attribute(node, name), .what = what, .kinds = kinds};
  char *part = strtok_r(text, blanks, &rest);
  for (size_t i = 0; i < count && part != NULL; i++, part = strtok_r(NULL, blanks, &rest))
    nodes[i] = parse_expression(reader->scope, part, location).node;
}

/* True if the text is one of the letters x, y and z. */
static bool is_letter(const char *text) {
  return strlen(text) == 1 && *text >= 'x' && *text <= 'z';
}

static bool read_axis(struct Reader *reader, xmlNodePtr node, struct Vector *axis) {
  struct Graph *graph = reader->model->graph;
  char *text = attribute(node, "axis");
  *axis = (struct Vector){{ZERO, ZERO, ZERO}};
  bool is_simple = is_letter(text);
  if (is_simple) axis->along[*text - 'x'] = ONE;
  if (is_simple) return true;
  read_expressions(reader, node, "axis", IN_MASS, 3, axis->along);
  if (definitions_are_waiting(reader->definitions)) return false;
  Node square = vector_dot(graph, *axis, *axis);
  if (square == ZERO && reader->diagnostics->errors == 0)
    report_at(reader, node, "the axis of <rotate> has the length 0; expected a direction, such as 0 0 1");
  if (square == ZERO) return false;
  *axis = vector_scale(graph, power_number(graph, square, -0.5), *axis);
  return true;
}

/* Warns of integers above 6 rad, which are probably degrees. Expressions such as 2*pi are no integers. */
static void warn_of_degrees(struct Reader *reader, xmlNodePtr node, struct Quantity angle) {
  const struct Graph *graph = reader->model->graph;
  if (!angle.literal || !graph_is_constant(graph, angle.node)) return;
  double value = graph_value(graph, angle.node);
  if (value == floor(value) && fabs(value) > 6.0)
    report_warning(reader->diagnostics, line_of(node),
                   "the angle is %g rad; expected radians, such as %g*pi/180 for degrees", value, value);
}

static void rotate_by_angle(struct Reader *reader, xmlNodePtr node, struct Pose *pose) {
  struct Quantity angle = {.node = ZERO};
  struct Vector axis;
  if (!read_axis(reader, node, &axis)) return;
  expression_attribute(reader, node, "angle", IN_POSITION, &angle);
  if (definitions_are_waiting(reader->definitions)) return;
  require_unit(reader, line_of_attribute(node, "angle"), "the angle", angle, unit_of("rad"));
  warn_of_degrees(reader, node, angle);
  pose_rotate(reader->model->graph, pose, axis, angle.node, total_time_derivative(reader->scope, angle.node));
}

/* Sets the norm constraint of a quaternion, q . q - 1 = 0, which was declared with the frame. */
static void set_norm(struct Reader *reader, xmlNodePtr node, const Node q[4]) {
  struct Model *model = reader->model;
  struct Graph *graph = model->graph;
  Node norm = graph_constant(graph, -1.0);
  char *frame = name_attribute(reader, node->parent, "name"), *name = format_text("%s.norm", frame);
  for (int i = 0; i < 4; i++) norm = add(graph, norm, power_number(graph, q[i], 2.0));
  for (size_t i = 0; i < model->constraints.count; i++)
    if (strcmp(model->constraints.items[i].name, name) == 0) model->constraints.items[i].node = norm;
  if (!graph_depends_on(graph, norm, COORDINATE))
    report_at(reader, node,
              "the quaternion of '%s' contains no coordinate; expected four coordinates, whose norm is kept at 1",
              frame);
}

static void rotate_by_quaternion(struct Reader *reader, xmlNodePtr node, struct Pose *pose) {
  Node q[4] = {ZERO, ZERO, ZERO, ZERO}, rate[4];
  read_expressions(reader, node, "quaternion", IN_MASS | KIND(COORDINATE) | KIND(TIME), 4, q);
  if (definitions_are_waiting(reader->definitions) || reader->diagnostics->errors > 0) return;
  for (int i = 0; i < 4; i++) rate[i] = total_time_derivative(reader->scope, q[i]);
  set_norm(reader, node, q);
  pose_rotate_by_quaternion(reader->model->graph, pose, q, rate);
}

static void check_parts(struct Reader *reader, xmlNodePtr node, const char *name, size_t expected) {
  char *text = attribute(node, name), *rest = NULL;
  size_t found = 0;
  bool is_simple = expected == 3 && is_letter(text);
  for (char *part = strtok_r(text, blanks, &rest); part != NULL; part = strtok_r(NULL, blanks, &rest)) found++;
  if (!is_simple && found != expected)
    report_at(reader, node,
              "%s of <rotate> has %zu parts; expected %zu expressions between blanks, without blanks in them%s", name,
              found, expected, expected == 3 ? ", or x, y or z" : "");
}

void check_rotation(struct Reader *reader, xmlNodePtr node) {
  bool by_quaternion = has_attribute(node, "quaternion"), by_axis = has_attribute(node, "axis");
  if (by_quaternion == by_axis || by_axis != has_attribute(node, "angle"))
    report_at(reader, node,
              "the rotation of <rotate> is not determined; expected axis=\"...\" angle=\"...\", or quaternion=\"...\"");
  else check_parts(reader, node, by_axis ? "axis" : "quaternion", by_axis ? 3 : 4);
  if (by_quaternion && node != quaternion_of(node->parent))
    report_at(reader, node, "a frame has a second quaternion; expected a <frame> in this one for it");
}

void rotate(struct Reader *reader, xmlNodePtr node, struct Pose *pose) {
  if (reader->diagnostics->errors > 0) return; /* check_rotation() may have reported an error */
  if (has_attribute(node, "quaternion")) rotate_by_quaternion(reader, node, pose);
  else rotate_by_angle(reader, node, pose);
}
