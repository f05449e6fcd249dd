#include "read/elements.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "algebra/differentiate.h"
#include "mechanics/energies.h"
#include "memory.h"
#include "read/constraint_reader.h"
#include "read/includes.h"
#include "read/named_expressions.h"
#include "algebra/simplify.h"
#include "read/parameters.h"
#include "read/similar.h"
#include "read/start_expressions.h"
#include "read/tables.h"

static const char *const axes[3] = {"x", "y", "z"};

struct Variable *append_variable(struct VariableList *list, struct Variable variable) {
  list->items = reallocate(list->items, list->count + 1, sizeof *list->items);
  list->items[list->count] = variable;
  return &list->items[list->count++];
}

struct Variable common_attributes(struct Reader *reader, xmlNodePtr node) {
  struct Variable variable = {.name = name_attribute(reader, node, "name"),
                              .description = attribute(node, "description"),
                              .unit = attribute(node, "unit"),
                              .dimension = unit_attribute(reader, node, "unit"),
                              .start = NAN,
                              .minimum = NAN,
                              .maximum = NAN,
                              .nominal = NAN,
                              .line = xmlGetLineNo(node)};
  if (variable.name == NULL) variable.name = copy_text("?"); /* reported already */
  return variable;
}

void check_range(struct Reader *reader, const struct Variable *variable) {
  if (variable->minimum > variable->maximum)
    report_error(reader->diagnostics, variable->line, "'%s': min %g is larger than max %g", variable->name,
                 variable->minimum, variable->maximum);
  else if (variable->start < variable->minimum || variable->start > variable->maximum)
    report_error(reader->diagnostics, variable->line, "'%s': start %g is outside min and max", variable->name,
                 variable->start);
}

static void read_constant(struct Reader *reader, xmlNodePtr node) {
  char *name = name_attribute(reader, node, "name");
  double value = 0;
  const struct Given *given = given_for(reader, node, name);
  bool right = name != NULL && given_number_attribute(reader, node, given, "value", &value);
  struct Place place = {.line = 0, .what = "-D"};
  for (size_t i = 0; right && i < reader->options->definition_count; i++) {
    const char *definition = reader->options->definitions[i];
    size_t length = strlen(name);
    if (strncmp(definition, name, length) != 0 || definition[length] != '=') continue;
    reader->definition_used[i] = true;
    right = parse_number(reader->scope, definition + length + 1, place, &value);
  }
  struct Quantity number = {
      .node = graph_constant(reader->model->graph, value), .dimension = dimension_one, .literal = true};
  if (name != NULL) scope_define(reader->scope, name, number, xmlGetLineNo(node));
  free(name);
}

static Node append_input_rate(struct Reader *reader) {
  struct VariableList *inputs = &reader->model->inputs;
  const struct Variable *of = &inputs->items[inputs->count - 1];
  struct Variable rate = {.name = format_text("der(%s)", of->name),
                          .description = format_text("time derivative of %s", of->name),
                          .dimension = dimension_multiply(of->dimension, unit_of("s"), -1.0),
                          .minimum = NAN,
                          .maximum = NAN,
                          .nominal = NAN,
                          .line = of->line};
  if (!of->dimension.known) rate.dimension = dimension_unknown;
  rate.node = scope_symbol(reader->scope, INPUT, (int)inputs->count, rate.name, rate.dimension, rate.line);
  scope_set_time_derivative(reader->scope, of->node, rate.node);
  append_variable(inputs, rate);
  return rate.node;
}

static double nominal_attribute(struct Reader *reader, xmlNodePtr node, const char *name) {
  double nominal = NAN;
  if (number_attribute(reader, node, name, &nominal) && !(nominal > 0)) {
    report_error(reader->diagnostics, xmlGetLineNo(node), "%s is %g; expected a positive number", name, nominal);
    nominal = NAN;
  }
  return nominal;
}

static void read_coordinate(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  struct Variable position = common_attributes(reader, node);
  struct Variable velocity = {.name = name_attribute(reader, node, "velocity"),
                              .description = attribute(node, "velocityDescription"),
                              .dimension = dimension_multiply(position.dimension, unit_of("s"), -1.0),
                              .minimum = NAN,
                              .maximum = NAN,
                              .line = position.line};
  if (velocity.name == NULL) velocity.name = copy_text("?");
  given_for(reader, node, position.name); /* is there, and read with the start values */
  if (velocity.description == NULL) velocity.description = format_text("velocity of %s", position.name);
  position.start = velocity.start = 0.0; /* see start_expressions.h */
  char *fixed = attribute(node, "fixed");
  position.is_fixed = fixed != NULL && (strcmp(fixed, "true") == 0 || strcmp(fixed, "1") == 0);
  free(fixed);
  position.nominal = nominal_attribute(reader, node, "nominal");
  velocity.nominal = nominal_attribute(reader, node, "velocityNominal");
  int index = (int)model->coordinates.count;
  position.node = scope_symbol(reader->scope, COORDINATE, index, position.name, position.dimension, position.line);
  velocity.node = scope_symbol(reader->scope, VELOCITY, index, velocity.name, velocity.dimension, velocity.line);
  position.line = velocity.line = scope_line(reader->scope, position.line);
  append_variable(&model->coordinates, position);
  append_variable(&model->velocities, velocity);
  model->drives = reallocate(model->drives, model->coordinates.count, sizeof *model->drives);
  model->drives[index] = (struct Drive){.given = xmlHasProp(node, (const xmlChar *)"acceleration") != NULL};
  model->drive_count += model->drives[index].given;
  model->has_forces |= model->drives[index].given;
}

/* Its rate, which is 0 too, lets velocities and what is made of them have their part in the force along it. */
static void read_displacement(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  struct Variable displacement = common_attributes(reader, node);
  int index = 2 * (int)model->displacements.count;
  displacement.node =
      scope_symbol(reader->scope, DISPLACEMENT, index, displacement.name, displacement.dimension, displacement.line);
  char *name = format_text("der(%s)", displacement.name);
  Node rate = scope_symbol(reader->scope, DISPLACEMENT, index + 1, name,
                           dimension_multiply(displacement.dimension, unit_of("s"), -1.0), displacement.line);
  scope_set_time_derivative(reader->scope, displacement.node, rate);
  append_variable(&model->displacements, displacement);
  free(name);
}

static void add_term(struct Model *model, struct Quantity *sum, Node term) {
  sum->node = add(model->graph, sum->node, term);
}

/* 1/2 inertia rate^2 */
static void add_kinetic_energy(struct Model *model, struct Scope *scope, Node inertia, Node position) {
  struct Graph *graph = model->graph;
  Node rate = total_time_derivative(scope, position);
  Node energy = scale(graph, 0.5, multiply(graph, inertia, power_number(graph, rate, 2.0)));
  add_term(model, &model->kinetic, energy);
  add_term(model, &model->kinetic_energy, energy);
  model->driven |= graph_depends_on(graph, position, TIME);
}

/* Where the body of a name is: its place among the model's, and the line of its own file. */
struct NamedBody {
  size_t place;
  long line;
};

static const struct Body *find_body(const struct Reader *reader, const char *name) {
  const struct NamedBody *named = names_find(reader->bodies, name);
  return named != NULL ? &reader->model->bodies[named->place] : NULL;
}

/* Of several bodies of one name, which is reported, the first keeps it. */
static void append_body(struct Reader *reader, struct Body body) {
  struct Model *model = reader->model;
  struct NamedBody *named = allocate(1, sizeof *named);
  *named = (struct NamedBody){model->body_count, body.line};
  if (find_body(reader, body.name) == NULL) names_set(reader->bodies, body.name, named);
  else free(named);
  body.line = scope_line(reader->scope, body.line);
  reader->source->body_count++;
  model->bodies = reallocate(model->bodies, model->body_count + 1, sizeof *model->bodies);
  model->bodies[model->body_count++] = body;
}

/* A component that definitions.h has read; true where it is given. */
static bool take_component(struct Reader *reader, const struct Body *body, xmlNodePtr node, const char *component,
                           struct Quantity *value, Node *displaced) {
  if (!xmlHasProp(node, (const xmlChar *)component)) return false;
  char *name = format_text("%s.%s", body->name, component);
  const struct Quantity *known = scope_find(reader->scope, name);
  if (known != NULL) *value = *known;
  *displaced = value->node;
  reader->model->inputs_move |= graph_depends_on(reader->model->graph, value->node, INPUT);
  value->node = without_displacements(reader, body->line, name, value->node);
  free(name);
  return true;
}

/*
 * Where mass joins or leaves, the equations depend on the momentum that it has, which a mass alone does not say:
 * d(m v)/dt = F + dm/dt w. Lagrange's equation of m(t) v^2/2 is that of w = 0, and of m(q) v^2/2 that of w = v/2.
 */
static void require_fixed(const struct Reader *reader, long line, const char *what, struct Quantity inertia,
                          const char *symbol, const char *rate) {
  const struct Graph *graph = reader->model->graph;
  if (graph_depends_on(graph, inertia.node, COORDINATE))
    report_error(
        reader->diagnostics, line,
        "the %s cannot depend on coordinates; expected %s=\"0\" and <kinetic>%s*%s^2/2</kinetic> with "
        "%s = der of the coordinate, which keeps the energy as a gear does, and a <force> of der(%s)*(w - %s/2) "
        "besides where it is mass that joins or leaves with the velocity w",
        what, what, symbol, rate, rate, symbol, rate);
  else if (graph_depends_on(graph, inertia.node, TIME))
    report_error(reader->diagnostics, line,
                 "the %s cannot depend on time; expected %s=\"0\" and <kinetic>%s*%s^2/2</kinetic>, which is "
                 "d(%s*%s)/dt = F, so that what joins or leaves is at rest, and a <force> of der(%s)*w besides where "
                 "it has the velocity w, as for thrust",
                 what, what, symbol, rate, symbol, rate, symbol);
  else if (graph_depends_on(graph, inertia.node, DISPLACEMENT))
    report_error(reader->diagnostics, line,
                 "the %s cannot depend on displacements; expected them in positions and angles", what);
}

/* A mass feels the second derivatives of the inputs that its position depends on; a mere point does not. */
static void require_accelerations(const struct Reader *reader, const struct Body *body, int component) {
  const struct Model *model = reader->model;
  struct Gradient levers = gradient_by_kinds(model->graph, body->displaced[component], KIND(INPUT));
  for (size_t i = 0; i < levers.count && (component < 3 ? body->mass.node : body->inertia.node) != ZERO; i++) {
    size_t input = (size_t)graph_symbol_of(model->graph, levers.symbols[i])->index;
    Node rate = model->input_rates[input];
    if (rate != ZERO && model->input_rates[graph_symbol_of(model->graph, rate)->index] != ZERO) continue;
    report_error(reader->diagnostics, body->line,
                 "the position of '%s', which has a mass, needs the second derivative of '%s'; expected %s, or "
                 "mass=\"0\" for a mere point",
                 body->name, model->inputs.items[input].name,
                 is_input_rate(model, input) ? "the <input> itself in place of its derivative"
                                             : "derivatives=\"2\" of this <input>");
  }
  gradient_free(&levers);
}

static void read_body(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  struct Body body = {.name = name_attribute(reader, node, "name"), .line = xmlGetLineNo(node)};
  if (body.name == NULL) body.name = format_text("%sbody%zu", reader->source->prefix, reader->source->body_count + 1);
  const struct Body *other = find_body(reader, body.name);
  if (other != NULL)
    report_error(reader->diagnostics, body.line,
                 "a particle or body named '%s' is already defined on line %ld; expected another name", body.name,
                 ((struct NamedBody *)names_find(reader->bodies, body.name))->line);
  expression_attribute(reader, node, "mass", IN_INERTIA, &body.mass);
  require_fixed(reader, body.line, "mass", body.mass, "m", "v");
  require_unit(reader, body.line, "the mass", body.mass, unit_of("kg"));
  for (int axis = 0; axis < 3 && other == NULL; axis++)
    body.has_position[axis] =
        take_component(reader, &body, node, axes[axis], &body.position[axis], &body.displaced[axis]);
  body.has_angle = other == NULL && take_component(reader, &body, node, "angle", &body.angle, &body.displaced[3]);
  if (body.has_angle) {
    expression_attribute(reader, node, "inertia", IN_INERTIA, &body.inertia);
    require_fixed(reader, body.line, "inertia", body.inertia, "J", "omega");
    require_unit(reader, body.line, "the inertia", body.inertia, unit_of("kg.m2"));
  }
  if (other == NULL && !body.has_position[0] && !body.has_position[1] && !body.has_position[2])
    report_error(reader->diagnostics, body.line, "<%s> has no position; expected x, y or z", (const char *)node->name);
  for (int component = 0; component < 4; component++) require_accelerations(reader, &body, component);
  for (int axis = 0; axis < 3; axis++)
    add_kinetic_energy(model, reader->scope, body.mass.node, body.position[axis].node);
  add_kinetic_energy(model, reader->scope, body.inertia.node, body.angle.node);
  append_body(reader, body);
}

/* Adds the element's expression to a sum, and as it is without displacements to another; returns the latter. */
static Node read_energy(struct Reader *reader, xmlNodePtr node, struct Quantity *displaced, struct Quantity *sum,
                        const char *what, unsigned kinds, const char *unit) {
  struct Quantity term = expression_text_of(reader, node, what, kinds);
  require_unit(reader, xmlGetLineNo(node), what, term, unit_of(unit));
  add_term(reader->model, displaced, term.node);
  reader->model->inputs_move |= (kinds & WITH_RATES) != 0 && graph_depends_on(reader->model->graph, term.node, INPUT);
  Node undisplaced = without_displacements(reader, xmlGetLineNo(node), what, term.node);
  add_term(reader->model, sum, undisplaced);
  return undisplaced;
}

static void read_kinetic(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  bool driven;
  Node term = read_energy(reader, node, &model->displaced_kinetic, &model->explicit_kinetic, "the kinetic energy",
                          IN_ENERGY, "J");
  add_term(model, &model->kinetic, term);
  add_term(model, &model->kinetic_energy, energy_of_kinetic_term(model, term, &driven));
  model->driven |= driven;
}

/* A search through all names is for messages that are shown. */
static bool are_shown(const struct Reader *reader) {
  return reader->diagnostics->errors < ERROR_LIMIT;
}

/* "did you mean 'theta'?" where the name is similar to a known one, else what was expected. Free with free(). */
static char *meant_coordinate(const struct Reader *reader, const char *name) {
  const struct Model *model = reader->model;
  struct Similar similar = {.wanted = name};
  for (size_t i = 0; i < model->coordinates.count && are_shown(reader); i++) {
    const char *known = model->coordinates.items[i].name;
    if (strcmp(name, model->velocities.items[i].name) == 0)
      return format_text("did you mean '%s', whose velocity it is?", known);
    similar_consider(&similar, known);
  }
  return similar.best != NULL ? format_text("did you mean '%s'?", similar.best)
                              : copy_text("expected the name of a <coordinate>");
}

static char *meant_body(const struct Reader *reader, const char *name) {
  struct Similar similar = {.wanted = name};
  for (size_t i = 0; i < reader->bodies->capacity && are_shown(reader); i++)
    if (reader->bodies->places[i].text != NULL) similar_consider(&similar, reader->bodies->places[i].text);
  return similar.best != NULL ? format_text("did you mean '%s'?", similar.best) : copy_text("expected the name of one");
}

/* The coordinate of this name, NULL where there is none. */
static const struct Symbol *find_coordinate(const struct Reader *reader, const char *name) {
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
    char *meant = meant_coordinate(reader, coordinate);
    report_error(reader->diagnostics, xmlGetLineNo(node), "there is no coordinate '%s' for this force; %s", coordinate,
                 meant);
    free(meant);
    return;
  }
  int index = symbol->index;
  struct Quantity force = expression_text_of(reader, node, "the force", IN_FORCE);
  require_unit(reader, xmlGetLineNo(node), "the force", force,
               dimension_multiply(unit_of("J"), model->coordinates.items[index].dimension, -1.0));
  add_term(model, &model->forces[index], without_displacements(reader, xmlGetLineNo(node), "the force", force.node));
}

/* The acceleration of a driven coordinate. */
static void read_drive(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  struct Quantity acceleration = {.node = ZERO};
  if (!expression_attribute(reader, node, "acceleration", IN_DRIVE, &acceleration)) return;
  char *name = name_attribute(reader, node, "name");
  const struct Symbol *symbol = name != NULL ? find_coordinate(reader, name) : NULL;
  free(name);
  if (symbol == NULL) return; /* the name was taken, which is reported */
  const struct Variable *velocity = &model->velocities.items[symbol->index];
  if (velocity->dimension.known)
    require_unit(reader, xmlGetLineNo(node), "the acceleration", acceleration,
                 dimension_multiply(velocity->dimension, unit_of("s"), -1.0));
  model->drives[symbol->index].acceleration = acceleration.node;
}

/* A force F along r contributes Q_i = F dr/dq_i (principle of virtual work); its power is F dr/dt. */
static void add_force(struct Model *model, Node position, Node force) {
  struct Graph *graph = model->graph;
  struct Gradient levers = gradient_by_kinds(graph, position, KIND(COORDINATE) | KIND(TIME));
  for (size_t i = 0; i < levers.count; i++) {
    const struct Symbol *symbol = graph_symbol_of(graph, levers.symbols[i]);
    struct Quantity *sum = symbol->kind == TIME ? &model->driven_power : &model->forces[symbol->index];
    add_term(model, sum, multiply(graph, force, levers.values[i]));
  }
  gradient_free(&levers);
}

static void append_point_force(struct Model *model, Node position, Node force) {
  model->point_forces = reallocate(model->point_forces, model->point_force_count + 1, sizeof *model->point_forces);
  model->point_forces[model->point_force_count++] = (struct PointForce){position, force};
}

static void add_cartesian_force(struct Reader *reader, xmlNodePtr node, const char *name) {
  struct Model *model = reader->model;
  const struct Body *body = find_body(reader, name);
  if (body == NULL) {
    char *meant = meant_body(reader, name);
    report_error(reader->diagnostics, xmlGetLineNo(node), "there is no particle or body '%s' for this force; %s", name,
                 meant);
    free(meant);
    return;
  }
  for (int axis = 0; axis < 3; axis++) {
    struct Quantity force;
    if (!expression_attribute(reader, node, axes[axis], IN_FORCE, &force)) continue;
    require_unit(reader, xmlGetLineNo(node), axes[axis], force, unit_of("N"));
    if (!body->has_position[axis])
      report_error(reader->diagnostics, xmlGetLineNo(node),
                   "a force along %s on '%s', which has no %s; expected a force along what it has", axes[axis], name,
                   axes[axis]);
    force.node = without_displacements(reader, xmlGetLineNo(node), axes[axis], force.node);
    add_force(model, body->position[axis].node, force.node);
    append_point_force(model, body->displaced[axis], force.node);
  }
}

static bool is_blank(xmlNodePtr node) {
  xmlChar *text = xmlNodeGetContent(node);
  bool blank = text == NULL || strspn((const char *)text, " \t\r\n") == strlen((const char *)text);
  xmlFree(text);
  return blank;
}

static void read_force(struct Reader *reader, xmlNodePtr node) {
  char *coordinate = reference_attribute(reader, node, "coordinate"), *on = reference_attribute(reader, node, "on");
  reader->model->has_forces = true;
  bool has_components = false;
  for (int axis = 0; axis < 3; axis++) has_components |= xmlHasProp(node, (const xmlChar *)axes[axis]) != NULL;
  if ((coordinate == NULL) == (on == NULL) || has_components != (on != NULL))
    report_error(reader->diagnostics, xmlGetLineNo(node),
                 "<force> needs either coordinate=\"...\" or on=\"...\" with x, y or z");
  else if (on != NULL && !is_blank(node))
    report_error(reader->diagnostics, xmlGetLineNo(node),
                 "<force on=\"%s\"> has a text; expected the force in x, y and z alone", on);
  else if (coordinate != NULL) add_generalized_force(reader, node, coordinate);
  else add_cartesian_force(reader, node, on);
  free(coordinate);
  free(on);
}

static void read_output(struct Reader *reader, xmlNodePtr node) {
  struct Variable output = common_attributes(reader, node);
  char *what = format_text("the output '%s'", output.name);
  struct Quantity value = expression_text_of(reader, node, what, IN_OUTPUT);
  require_unit(reader, output.line, what, value, output.dimension);
  if (!output.dimension.known) output.dimension = value.dimension;
  output.node = value.node = without_displacements(reader, output.line, what, value.node);
  value.dimension = output.dimension;
  scope_define(reader->scope, output.name, value, output.line);
  free(what);
  output.line = scope_line(reader->scope, output.line);
  append_variable(&reader->model->outputs, output);
}

void read_solver(struct Reader *reader, xmlNodePtr node) {
  char *method = attribute(node, "method");
  reader->model->solver_line = xmlGetLineNo(node);
  if (reader->has_solver) report_error(reader->diagnostics, xmlGetLineNo(node), "a second <solver>; expected one");
  reader->has_solver = true;
  if (method != NULL) reader->model->method = method_named(method);
  double *tolerance = &reader->model->tolerance;
  if (number_attribute(reader, node, "tolerance", tolerance) && !(*tolerance > 0 && *tolerance < 1))
    report_error(reader->diagnostics, xmlGetLineNo(node), "tolerance %g; expected a number between 0 and 1",
                 *tolerance);
  if (*tolerance > 0 && *tolerance < 1e-14)
    report_warning(reader->diagnostics, xmlGetLineNo(node),
                   "tolerance %g is below what doubles can hold; expected 1e-14 or more", *tolerance);
  number_attribute(reader, node, "maxStep", &reader->model->max_step);
  double *steps = &reader->model->max_steps;
  if (number_attribute(reader, node, "maxSteps", steps) && !(*steps >= 1 && *steps <= 1e9 && *steps == floor(*steps)))
    report_error(reader->diagnostics, xmlGetLineNo(node), "maxSteps %g; expected a whole number from 1 to 1e9", *steps);
  free(method);
}

void read_experiment(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  if (reader->has_experiment)
    report_error(reader->diagnostics, xmlGetLineNo(node), "a second <experiment>; expected one");
  reader->has_experiment = true;
  number_attribute(reader, node, "startTime", &model->start_time);
  number_attribute(reader, node, "stopTime", &model->stop_time);
  if (number_attribute(reader, node, "stepSize", &model->step_size) && !(model->step_size > 0))
    report_error(reader->diagnostics, xmlGetLineNo(node), "stepSize %g; expected a positive number", model->step_size);
  double start = isnan(model->start_time) ? 0.0 : model->start_time;
  if (model->stop_time <= start)
    report_error(reader->diagnostics, xmlGetLineNo(node), "stopTime %g is not after startTime %g", model->stop_time,
                 start);
}

/* Further inputs that are the time derivatives of the last one. */
static void read_input_rates(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  double derivatives = 0;
  if (number_attribute(reader, node, "derivatives", &derivatives) && derivatives != 1 && derivatives != 2)
    report_error(reader->diagnostics, xmlGetLineNo(node), "derivatives=\"%g\" of <input>; expected 1 or 2",
                 derivatives);
  model->input_rates = reallocate(model->input_rates, model->inputs.count + 2, sizeof *model->input_rates);
  size_t index = model->inputs.count - 1;
  for (int k = 1; k <= 2; k++) model->input_rates[index++] = derivatives >= k ? append_input_rate(reader) : ZERO;
  if (derivatives >= 2) model->input_rates[index] = ZERO;
}

static void read_input(struct Reader *reader, xmlNodePtr node) {
  struct VariableList *list = &reader->model->inputs;
  struct Variable variable = common_attributes(reader, node);
  const struct Given *given = given_for(reader, node, variable.name);
  if (is_given(given, "value")) { /* an expression like a definition */
    check_calculated(reader, given, node);
    variable_free(&variable);
    return;
  }
  variable.start = 0.0;
  given_number_attribute(reader, node, given, "start", &variable.start);
  given_number_attribute(reader, node, given, "min", &variable.minimum);
  given_number_attribute(reader, node, given, "max", &variable.maximum);
  check_range(reader, &variable);
  variable.node =
      scope_symbol(reader->scope, INPUT, (int)list->count, variable.name, variable.dimension, variable.line);
  variable.line = scope_line(reader->scope, variable.line);
  append_variable(list, variable);
  read_input_rates(reader, node);
}

/* Solver, experiment and work are the system's own. */
static void read_declaration(struct Reader *reader, xmlNodePtr node, const char *element) {
  struct Model *model = reader->model;
  if (strcmp(element, "constant") == 0) read_constant(reader, node);
  else if (strcmp(element, "parameter") == 0) read_parameter(reader, node);
  else if (strcmp(element, "input") == 0) read_input(reader, node);
  else if (strcmp(element, "coordinate") == 0) read_coordinate(reader, node);
  else if (strcmp(element, "displacement") == 0) read_displacement(reader, node);
  else if (strcmp(element, "table") == 0) read_table(reader, node);
  else if (strcmp(element, "constraint") == 0) declare_constraint(reader, node);
  else if (reader->source->outer != NULL) return;
  else if (strcmp(element, "solver") == 0) read_solver(reader, node);
  else if (strcmp(element, "experiment") == 0) read_experiment(reader, node);
  else if (strcmp(element, "work") == 0) model->work_line = xmlGetLineNo(node);
}

static void read_dissipation(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  Node dissipation =
      read_energy(reader, node, &model->displaced_dissipation, &model->dissipation, "the dissipation", IN_FORCE, "W");
  if (dissipation != ZERO && !graph_depends_on(model->graph, dissipation, VELOCITY))
    report_warning(reader->diagnostics, xmlGetLineNo(node),
                   "the dissipation has no velocities, and makes no force; expected one such as b*v^2/2");
  size_t count = reader->dissipation_count++;
  reader->dissipations = reallocate(reader->dissipations, count + 1, sizeof *reader->dissipations);
  reader->dissipations[count] = (struct Dissipation){dissipation, scope_line(reader->scope, xmlGetLineNo(node))};
  model->has_forces = true;
}

static void read_expression(struct Reader *reader, xmlNodePtr node, const char *element) {
  struct Model *model = reader->model;
  if (strcmp(element, "kinetic") == 0) read_kinetic(reader, node);
  else if (strcmp(element, "potential") == 0)
    read_energy(reader, node, &model->displaced_potential, &model->potential, "the potential", IN_ENERGY, "J");
  else if (strcmp(element, "dissipation") == 0) read_dissipation(reader, node);
  else if (strcmp(element, "coordinate") == 0) read_drive(reader, node);
  else if (strcmp(element, "force") == 0) read_force(reader, node);
  else if (strcmp(element, "output") == 0) read_output(reader, node);
  else if (strcmp(element, "constraint") == 0) read_constraint(reader, node);
}

void read_element(struct Reader *reader, xmlNodePtr node, enum Pass pass) {
  const char *element = (const char *)node->name;
  if (pass == DECLARATIONS) read_declaration(reader, node, element);
  else if (pass == EXPRESSIONS) read_expression(reader, node, element);
  else if (pass == DEFINITIONS) collect_named_expressions(reader, node);
  else if (strcmp(element, "coordinate") == 0) read_start_expressions(reader, node);
  else if (strcmp(element, "particle") == 0 || strcmp(element, "body") == 0) read_body(reader, node);
}
