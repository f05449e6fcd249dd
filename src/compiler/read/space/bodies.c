#include "read/space/bodies.h"

#include "algebra/differentiate.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "read/context/includes.h"
#include "read/space/frames.h"

/* Adds half of the term to the kinetic energy. */
static void append_energy(struct Model *model, Node term) {
  Node energy = scale(model->graph, 0.5, term);
  add_term(model, &model->energies.kinetic, energy);
  add_term(model, &model->energies.kinetic_energy, energy);
}

/* Adds inertia rate^2 / 2, rate being the time derivative of the position. */
static void add_kinetic_energy(struct Model *model, struct Scope *scope, Node inertia, Node position) {
  struct Graph *graph = model->graph;
  Node rate = total_time_derivative(scope, position);
  append_energy(model, multiply(graph, inertia, power_number(graph, rate, 2.0)));
  model->energies.has_prescribed |= graph_depends_on(graph, position, TIME);
}

/* A body's index in the model, and its line in its own file. */
struct NamedBody {
  size_t index;
  long line;
};

const struct Body *find_body(const struct Reader *reader, const char *name) {
  const struct NamedBody *named = names_find(reader->bodies, name);
  return named != NULL ? &reader->model->mechanism.bodies[named->index] : NULL;
}

/* If several bodies have the same name, which is reported, the name refers to the first. */
static void append_body(struct Reader *reader, struct Body body) {
  struct Model *model = reader->model;
  struct NamedBody *named = allocate(1, sizeof *named);
  *named = (struct NamedBody){model->mechanism.body_count, body.line};
  if (find_body(reader, body.name) == NULL) names_set(reader->bodies, body.name, named);
  body.line = scope_line(reader->scope, body.line);
  APPEND(model->mechanism.bodies, model->mechanism.body_count, body);
}

/*
 * Sets the value of a component that was read as a named expression, with and without displacements. Returns true if
 * the element has the component.
 */
static bool take_component(struct Reader *reader, const struct Body *body, xmlNodePtr node, const char *component,
                           struct Quantity *value, Node *displaced) {
  if (!has_attribute(node, component)) return false;
  char *name = format_text("%s.%s", body->name, component);
  const struct Quantity *known = scope_find(reader->scope, name);
  if (known != NULL) *value = *known;
  *displaced = value->node;
  reader->model->prescribed.inputs_move |= graph_depends_on(reader->model->graph, value->node, INPUT);
  value->node = without_displacements(reader, body->line, name, value->node);
  return true;
}

/*
 * Reports an inertia that varies. Equations of motion of variable mass depend on the velocity w of the mass that joins
 * or leaves, d(m v)/dt = F + dm/dt w, which a body does not specify. Lagrange's equations imply w = 0 for the energy
 * m(t) v^2/2, and w = v/2 for m(q) v^2/2.
 */
static void require_fixed(const struct Reader *reader, long line, const char *what, struct Quantity inertia,
                          const char *symbol, const char *rate) {
  const struct Graph *graph = reader->model->graph;
  if (graph_depends_on(graph, inertia.node, COORDINATE))
    report_error(
        reader->diagnostics, line,
        "the %s cannot depend on coordinates; expected %s=\"0\" and <kinetic>%s*%s^2/2</kinetic> with "
        "%s = der of the coordinate, which conserves energy as a gear does; add a <force> of der(%s)*(w - %s/2) "
        "if mass joins or leaves with the velocity w",
        what, what, symbol, rate, rate, symbol, rate);
  else if (graph_depends_on(graph, inertia.node, TIME))
    report_error(reader->diagnostics, line,
                 "the %s cannot depend on time; expected %s=\"0\" and <kinetic>%s*%s^2/2</kinetic>, which is "
                 "d(%s*%s)/dt = F for mass that joins or leaves at rest; add a <force> of der(%s)*w if "
                 "it has the velocity w, as for thrust",
                 what, what, symbol, rate, symbol, rate, symbol);
  else if (graph_depends_on(graph, inertia.node, DISPLACEMENT))
    report_error(reader->diagnostics, line,
                 "the %s cannot depend on displacements; expected them in positions and angles", what);
}

/* Reports inputs that prescribe the motion of a body with mass and lack second derivatives. */
static void require_accelerations(const struct Reader *reader, const struct Body *body, int component) {
  const struct Model *model = reader->model;
  struct Gradient gradient = gradient_by_kinds(model->graph, body->displaced[component], KIND(INPUT));
  for (size_t i = 0; i < gradient.count && (component < 3 ? body->mass.node : body->inertia.node) != ZERO; i++) {
    size_t input = (size_t)graph_symbol_of(model->graph, gradient.symbols[i])->index;
    Node rate = model->prescribed.input_rates[input];
    if (rate != ZERO && model->prescribed.input_rates[graph_symbol_of(model->graph, rate)->index] != ZERO) continue;
    report_error(reader->diagnostics, body->line,
                 "the position of '%s', which has a mass, needs the second derivative of '%s'; expected %s, or "
                 "mass=\"0\" for a point without mass",
                 body->name, model->inputs.items[input].name,
                 is_input_rate(model, input) ? "the <input> itself in place of its derivative"
                                             : "derivatives=\"2\" of this <input>");
  }
}

void number_body(struct Reader *reader, xmlNodePtr node) {
  (void)node;
  reader->present->number = ++reader->source->body_count;
}

char *name_of_body(struct Reader *reader, xmlNodePtr node) {
  char *name = name_attribute(reader, node, "name");
  if (name != NULL || is_element(node, "point") || is_element(node, "frame")) return name;
  return format_text("%sbody%zu", reader->source->prefix, reader->present->number);
}

static void read_mass(struct Reader *reader, xmlNodePtr node, struct Body *body) {
  expression_attribute(reader, node, "mass", IN_INERTIA, &body->mass);
  require_fixed(reader, body->line, "mass", body->mass, "m", "v");
  require_unit(reader, line_of_attribute(node, "mass"), "the mass", body->mass, unit_of("kg"));
}

static const struct Body *report_same_name(const struct Reader *reader, const struct Body *body) {
  const struct Body *other = find_body(reader, body->name);
  if (other != NULL)
    report_error(
        reader->diagnostics, body->line,
        "a particle or body named '%s' is already defined on line %ld; expected another name", body->name,
        file_line(reader->diagnostics, ((struct NamedBody *)names_find(reader->bodies, body->name))->line).line);
  return other;
}

static void read_planar_body(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  struct Body body = {.name = name_of_body(reader, node), .line = line_of(node)};
  const struct Body *other = report_same_name(reader, &body);
  read_mass(reader, node, &body);
  for (int axis = 0; axis < 3 && other == NULL; axis++)
    body.has_position[axis] =
        take_component(reader, &body, node, axes[axis], &body.position[axis], &body.displaced[axis]);
  body.has_angle = other == NULL && take_component(reader, &body, node, "angle", &body.angle, &body.displaced[3]);
  if (body.has_angle) {
    expression_attribute(reader, node, "inertia", IN_INERTIA, &body.inertia);
    require_fixed(reader, body.line, "inertia", body.inertia, "J", "omega");
    require_unit(reader, line_of_attribute(node, "inertia"), "the inertia", body.inertia, unit_of("kg.m2"));
  }
  if (other == NULL && !body.has_position[0] && !body.has_position[1] && !body.has_position[2])
    report_error(reader->diagnostics, body.line, "<%s> has no position; expected x, y or z", (const char *)node->name);
  for (int component = 0; component < 4; component++) require_accelerations(reader, &body, component);
  for (int axis = 0; axis < 3; axis++)
    add_kinetic_energy(model, reader->scope, body.mass.node, body.position[axis].node);
  add_kinetic_energy(model, reader->scope, body.inertia.node, body.angle.node);
  if (other == NULL) append_element_variables(reader, node, body.name);
  append_body(reader, body);
}

/* Reads the moments and products of inertia into the symmetric tensor. */
static void read_tensor(struct Reader *reader, xmlNodePtr node, struct Body *body) {
  static const char *const names[3][3] = {{"Ixx", "Ixy", "Ixz"}, {"Ixy", "Iyy", "Iyz"}, {"Ixz", "Iyz", "Izz"}};
  for (int i = 0; i < 3; i++)
    for (int j = i; j < 3; j++) {
      struct Quantity moment = {.node = ZERO};
      if (!expression_attribute(reader, node, names[i][j], IN_MASS, &moment)) continue;
      require_unit(reader, line_of_attribute(node, names[i][j]), names[i][j], moment, unit_of("kg.m2"));
      body->tensor.row[i].along[j] = body->tensor.row[j].along[i] = moment.node;
    }
}

/* Sets the position and velocities of the body from its named expression. */
static void place_body(struct Reader *reader, const struct SpatialPoint *point, struct Body *body) {
  const struct Model *model = reader->model;
  body->is_in_frame = true;
  body->frame = point->frame;
  body->offset = vector_without_displacements(reader, body->line, body->name, point->offset);
  body->displaced_velocity = point->velocity;
  body->displaced_angular_velocity = model->mechanism.frames[point->frame].pose.angular_velocity;
  body->velocity = vector_without_displacements(reader, body->line, body->name, point->velocity);
  body->angular_velocity =
      vector_without_displacements(reader, body->line, body->name, body->displaced_angular_velocity);
  struct Vector position = vector_without_displacements(reader, body->line, body->name, point->position);
  for (int axis = 0; axis < 3; axis++) {
    body->has_position[axis] = true;
    body->displaced[axis] = point->position.along[axis];
    body->position[axis] = (struct Quantity){.node = position.along[axis], .dimension = unit_of("m")};
  }
}

/* Reports inputs that prescribe the rotation of the frame without their second derivatives. */
static void require_angular_accelerations(const struct Reader *reader, const struct Body *body) {
  const struct Matrix *rotation = &reader->model->mechanism.frames[body->frame].pose.rotation;
  struct Body rotated = *body;
  for (int i = 0; i < 9; i++) {
    rotated.displaced[0] = rotation->row[i / 3].along[i % 3];
    require_accelerations(reader, &rotated, 0);
  }
}

static void add_spatial_energy(struct Model *model, const struct Body *body) {
  struct Graph *graph = model->graph;
  struct Vector momentum = matrix_apply(graph, &body->tensor, body->angular_velocity);
  append_energy(model, multiply(graph, body->mass.node, vector_dot(graph, body->velocity, body->velocity)));
  append_energy(model, vector_dot(graph, body->angular_velocity, momentum));
  for (int i = 0; i < 3; i++)
    model->energies.has_prescribed |= graph_depends_on(graph, body->position[i].node, TIME) ||
                                      graph_depends_on(graph, body->angular_velocity.along[i], TIME);
}

/* Reads a particle, body or point in a frame. */
static void read_spatial_body(struct Reader *reader, xmlNodePtr node) {
  struct Body body = {.name = name_of_body(reader, node), .line = line_of(node)};
  struct SpatialPoint point;
  if (body.name == NULL) return; /* the error has been reported */
  const struct Body *other = report_same_name(reader, &body);
  if (!is_element(node, "point")) read_mass(reader, node, &body);
  if (is_element(node, "body")) read_tensor(reader, node, &body);
  if (other != NULL || reader->diagnostics->errors > 0 || !find_spatial_point(reader, body.name, &point)) return;
  place_body(reader, &point, &body);
  for (int axis = 0; axis < 3; axis++) require_accelerations(reader, &body, axis);
  if (body.mass.node != ZERO) require_angular_accelerations(reader, &body);
  add_spatial_energy(reader->model, &body);
  append_element_variables(reader, node, body.name);
  append_body(reader, body);
}

/* True if a body has either an angle and an inertia, or a frame and a tensor; reports an error otherwise. */
static bool has_right_attributes(struct Reader *reader, xmlNodePtr node) {
  static const char *const moments[] = {"Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz"};
  bool is_in_frame = has_attribute(node, "in"), has_moments = false;
  bool has_angle = has_attribute(node, "angle"), has_inertia = has_attribute(node, "inertia");
  for (int i = 0; i < 6; i++) has_moments |= has_attribute(node, moments[i]);
  if (!is_element(node, "body")) return true;
  if (is_in_frame ? !has_angle && !has_inertia : has_angle && has_inertia && !has_moments) return true;
  report_at(reader, node,
            is_in_frame
                ? "a <body> in a frame rotates with it; expected Ixx, Iyy, Izz, Ixy, Ixz, Iyz in place of angle "
                  "and inertia"
                : "the rotation of <body> is not determined; expected angle and inertia, or in=\"...\" with the name "
                  "of a frame or base, and Ixx, Iyy, Izz, Ixy, Ixz, Iyz");
  return false;
}

void read_body(struct Reader *reader, xmlNodePtr node) {
  if (is_element(node, "frame")) {
    char *name = name_attribute(reader, node, "name");
    if (name != NULL) append_element_variables(reader, node, name);
  } else if (!has_right_attributes(reader, node)) return;
  else if (is_spatial(node)) read_spatial_body(reader, node);
  else read_planar_body(reader, node);
}
