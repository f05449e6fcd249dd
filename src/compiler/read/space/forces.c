#include "read/space/forces.h"

#include <string.h>

#include "algebra/differentiate.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "read/context/includes.h"
#include "names/similar.h"
#include "read/space/bodies.h"
#include "read/space/frames.h"

/* True if further messages are printed. Otherwise searching for similar names is a waste of time. */
static bool are_shown(const struct Reader *reader) {
  return reader->diagnostics->errors < ERROR_LIMIT;
}

/* Returns "did you mean 'theta'?" for a similar name, or the expected kind of name. */
static const char *similar_coordinate(const struct Reader *reader, const char *name) {
  const struct Model *model = reader->model;
  struct SimilarName similar = {.wanted = name};
  for (size_t i = 0; i < model->coordinates.count && are_shown(reader); i++) {
    const char *known = model->coordinates.items[i].name;
    if (strcmp(name, model->velocities.items[i].name) == 0)
      return format_text("did you mean '%s', whose velocity it is?", known);
    similar_consider(&similar, known);
  }
  return suggestion(similar.best, "expected the name of a <coordinate>");
}

static const char *similar_body(const struct Reader *reader, const char *name) {
  struct SimilarName similar = {.wanted = name};
  if (are_shown(reader)) similar_consider_all(&similar, reader->bodies);
  return suggestion(similar.best, "expected the name of one");
}

const struct Symbol *find_coordinate(const struct Reader *reader, const char *name) {
  const struct Graph *graph = reader->model->graph;
  const struct Quantity *quantity = scope_find(reader->scope, name);
  if (quantity == NULL || graph->vertices[quantity->node].operation != SYMBOL) return NULL;
  const struct Symbol *symbol = graph_symbol_of(graph, quantity->node);
  return symbol->kind == COORDINATE && strcmp(symbol->name, name) == 0 ? symbol : NULL;
}

static void add_generalized_force(struct Reader *reader, xmlNodePtr node, const char *coordinate) {
  struct Model *model = reader->model;
  const struct Symbol *symbol = find_coordinate(reader, coordinate);
  if (symbol == NULL) {
    report_at(reader, node, "there is no coordinate '%s' for this force; %s", coordinate,
              similar_coordinate(reader, coordinate));
    return;
  }
  int index = symbol->index;
  struct Quantity force = expression_text_of(reader, node, "the force", IN_FORCE);
  require_unit(reader, line_of(node), "the force", force,
               dimension_multiply(unit_of("J"), model->coordinates.items[index].dimension, -1.0));
  add_term(model, &model->forces.along[index], without_displacements(reader, line_of(node), "the force", force.node));
}

void add_virtual_work(struct Model *model, Node force, const struct Gradient *gradient) {
  for (size_t i = 0; i < gradient->count; i++) {
    const struct Symbol *symbol = graph_symbol_of(model->graph, gradient->symbols[i]);
    struct Quantity *sum = symbol->kind == TIME ? &model->forces.prescribed_power : &model->forces.along[symbol->index];
    add_term(model, sum, multiply(model->graph, force, gradient->values[i]));
  }
}

static void append_point_force(struct Model *model, Node position, Node force) {
  APPEND(model->forces.at_points, model->forces.point_count, (struct PointForce){position, force});
}

static void report_unknown_body(struct Reader *reader, xmlNodePtr node, const char *name, const char *what) {
  report_at(reader, node, "there is no %s '%s' for this %s; %s", what, name, (const char *)node->name,
            similar_body(reader, name));
}

/* Reads the components of a force or torque along the axes of the frame that attribute `in` names. */
static struct Vector read_components(struct Reader *reader, xmlNodePtr node, const char *unit) {
  struct Vector vector = {{ZERO, ZERO, ZERO}};
  for (int axis = 0; axis < 3; axis++) {
    struct Quantity component;
    if (!expression_attribute(reader, node, axes[axis], IN_FORCE, &component)) continue;
    require_unit(reader, line_of_attribute(node, axes[axis]), axes[axis], component, unit_of(unit));
    vector.along[axis] = without_displacements(reader, line_of(node), axes[axis], component.node);
  }
  return vector;
}

/* Returns the rotation matrix of a frame at zero displacements. */
static struct Matrix rotation_of(struct Reader *reader, long line, const struct ReferenceFrame *frame) {
  return matrix_without_displacements(reader, line, frame->name, frame->pose.rotation);
}

void add_force_along(struct Reader *reader, long line, const char *name, Node displaced, Node force) {
  struct Model *model = reader->model;
  struct Gradient gradient = gradient_by_kinds(model->graph, without_displacements(reader, line, name, displaced),
                                               KIND(COORDINATE) | KIND(TIME));
  add_virtual_work(model, force, &gradient);
  append_point_force(model, displaced, force);
}

static void add_cartesian_force(struct Reader *reader, xmlNodePtr node, const char *name) {
  struct Model *model = reader->model;
  const struct Body *body = find_body(reader, name);
  struct SpatialPoint point;
  long line = line_of(node);
  const struct ReferenceFrame *frame = frame_of_attribute(reader, node, "in");
  struct Vector force = read_components(reader, node, "N");
  if (body == NULL && !find_spatial_point(reader, name, &point)) {
    report_unknown_body(reader, node, name, "particle, body, point or frame");
    return;
  }
  if (frame == NULL) return;
  struct Matrix rotation = rotation_of(reader, line, frame);
  force = matrix_apply(model->graph, &rotation, force);
  for (int axis = 0; axis < 3; axis++) {
    bool is_given = has_attribute(node, axes[axis]) && !has_attribute(node, "in");
    if (body != NULL && !body->has_position[axis] && is_given)
      report_error(reader->diagnostics, line,
                   "a force along %s on '%s', which has no %s; expected a force along another axis", axes[axis], name,
                   axes[axis]);
    Node displaced = body != NULL ? body->displaced[axis] : point.position.along[axis];
    add_force_along(reader, line, name, displaced, force.along[axis]);
  }
}

/* Returns the part of an angular velocity that is prescribed by time, at zero velocities and rates of inputs. */
static struct Vector prescribed_part(const struct Model *model, struct Vector velocity) {
  struct Graph *graph = model->graph;
  Node *at_rest = allocate(graph->symbol_count, sizeof *at_rest);
  for (size_t i = 0; i < graph->symbol_count; i++) {
    const struct Symbol *symbol = &graph->symbols[i];
    bool is_rate = symbol->kind == VELOCITY || (symbol->kind == INPUT && is_input_rate(model, (size_t)symbol->index));
    at_rest[i] = is_rate ? ZERO : symbol->node;
  }
  substitute(graph, velocity.along, 3, at_rest, velocity.along);
  return velocity;
}

/*
 * Adds the generalized forces Q_i = T . d omega / d v_i of a torque T, and its power T . omega. Both vectors are along
 * the axes of the frame that the torque acts on.
 */
static void add_torque(struct Reader *reader, long line, struct Vector torque, struct Vector displaced) {
  struct Model *model = reader->model;
  struct Graph *graph = model->graph;
  struct Vector velocity = vector_without_displacements(reader, line, "the torque", displaced);
  struct Gradient gradient = weighted_gradient(graph, velocity.along, torque.along, 3, KIND(VELOCITY));
  add_virtual_work(model, ONE, &gradient);
  add_term(model, &model->forces.prescribed_power, vector_dot(graph, torque, prescribed_part(model, velocity)));
  APPEND(model->forces.torques, model->forces.torque_count, (struct Torque){torque, displaced});
}

void add_torque_on(struct Reader *reader, long line, struct Vector torque, const struct ReferenceFrame *frame) {
  struct Matrix rotation = rotation_of(reader, line, frame);
  torque = matrix_apply_transposed(reader->model->graph, &rotation, torque);
  add_torque(reader, line, torque, frame->pose.angular_velocity);
}

void read_torque(struct Reader *reader, xmlNodePtr node) {
  char *name = reference_attribute(reader, node, "on");
  const struct ReferenceFrame *target = name != NULL ? find_frame(reader, name) : NULL;
  const struct ReferenceFrame *frame = frame_of_attribute(reader, node, "in");
  struct Vector torque = read_components(reader, node, "N.m");
  long line = line_of(node);
  reader->model->forces.any = true;
  if (name != NULL && target == NULL) report_unknown_body(reader, node, name, "frame or body");
  if (target != NULL && frame != NULL) {
    if (frame != target) {
      struct Matrix to_base = rotation_of(reader, line, frame);
      add_torque_on(reader, line, matrix_apply(reader->model->graph, &to_base, torque), target);
    } else add_torque(reader, line, torque, target->pose.angular_velocity);
  }
}

/* True if the name was defined in the current file, not in a file that it includes or is included by. */
static bool is_of_file(const struct Reader *reader, const char *name) {
  const char *prefix = reader->source->prefix;
  return strncmp(name, prefix, strlen(prefix)) == 0 && strchr(name + strlen(prefix), '.') == NULL;
}

void read_gravity(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  struct Graph *graph = model->graph;
  for (int axis = 0; axis < 3; axis++) {
    struct Quantity gravity = {.node = ZERO};
    if (!expression_attribute(reader, node, axes[axis], IN_MASS, &gravity)) continue;
    require_unit(reader, line_of_attribute(node, axes[axis]), axes[axis], gravity, unit_of("m/s2"));
    model->mechanism.gravity.along[axis] = gravity.node;
    for (size_t i = 0; i < model->mechanism.body_count; i++) {
      const struct Body *body = &model->mechanism.bodies[i];
      if (!is_of_file(reader, body->name)) continue;
      Node weight = negate(graph, multiply(graph, body->mass.node, gravity.node));
      add_term(model, &model->energies.potential, multiply(graph, weight, body->position[axis].node));
      add_term(model, &model->energies.displaced_potential, multiply(graph, weight, body->displaced[axis]));
    }
  }
}

static bool is_blank(xmlNodePtr node) {
  xmlChar *text = xmlNodeGetContent(node);
  bool blank = text == NULL || strspn((const char *)text, " \t\r\n") == strlen((const char *)text);
  xmlFree(text);
  return blank;
}

void read_force(struct Reader *reader, xmlNodePtr node) {
  char *coordinate = reference_attribute(reader, node, "coordinate"), *on = reference_attribute(reader, node, "on");
  reader->model->forces.any = true;
  bool has_components = false;
  for (int axis = 0; axis < 3; axis++) has_components |= has_attribute(node, axes[axis]);
  bool is_along_frame = has_attribute(node, "in");
  if ((coordinate == NULL) == (on == NULL) || has_components != (on != NULL) || (is_along_frame && on == NULL))
    report_at(
        reader, node,
        "the direction of <force> is not determined; expected coordinate=\"...\" alone, or on=\"...\" with x, y or z");
  else if (on != NULL && !is_blank(node))
    report_at(reader, node, "<force on=\"%s\"> contains text; expected the force in x, y and z only", on);
  else if (coordinate != NULL) add_generalized_force(reader, node, coordinate);
  else add_cartesian_force(reader, node, on);
}
