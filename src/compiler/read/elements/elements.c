#include "read/elements/elements.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "mechanics/energies.h"
#include "read/context/includes.h"
#include "read/context/value_texts.h"
#include "read/context/variables.h"
#include "read/elements/named_expressions.h"
#include "read/elements/parameters.h"
#include "read/context/readers.h"
#include "read/elements/start_expressions.h"
#include "read/elements/switching_reader.h"
#include "names/definitions.h"
#include "read/shapes/drawn_lines.h"
#include "read/shapes/shapes.h"
#include "read/space/bodies.h"
#include "read/space/forces.h"
#include "read/space/frames.h"
#include "read/space/joints.h"
#include "read/space/springs.h"

/* Reads the value of a constant: override, list item or attribute. Returns false for none or after an error. */
static bool read_constant_value(struct Reader *reader, xmlNodePtr node, const struct Override *overrides, char *listed,
                                struct Quantity *value) {
  const struct Override *override = override_of_attribute(overrides, "value");
  struct Source *present = enter_override(reader, override, &node);
  char *text = listed != NULL && override == NULL ? listed : attribute(node, "value");
  bool right =
      text != NULL && *text != '\0' && parse_constant(reader->scope, text, location_of(node, "value", 0), value);
  source_enter(reader, present);
  return right;
}

/* Reads the value of -D: an expression of constants, or a number with a unit that fits to that of the constant. */
static bool read_defined(struct Reader *reader, xmlNodePtr node, const char *name, const char *text,
                         struct Quantity *value) {
  struct Location location = {.line = 0, .what = "-D"};
  const char *unit = has_attribute(node, "unit") ? attribute(node, "unit") : "1";
  double number = 0.0;
  if (!value_has_unit(text)) return parse_constant(reader->scope, text, location, value);
  bool is_read = value_of_option(format_text("-D %s", name), text, unit, reader->diagnostics, &number);
  *value = (struct Quantity){
      .node = graph_constant(reader->model->graph, number), .dimension = dimension_one, .literal = true};
  return is_read;
}

/* Defines a constant. listed: its value in a list; NULL if it has an attribute. */
static void define_constant(struct Reader *reader, xmlNodePtr node, char *name, char *listed) {
  struct Quantity value = {.node = ZERO, .dimension = dimension_one, .literal = true};
  const struct Override *overrides = overrides_of(reader, node, name);
  bool right = read_constant_value(reader, node, overrides, listed, &value);
  for (size_t i = 0; right && i < reader->options->definition_count; i++) {
    const char *definition = reader->options->definitions[i];
    size_t length = strlen(name);
    if (strncmp(definition, name, length) != 0 || definition[length] != '=') continue;
    reader->definition_used[i] = true;
    right = read_defined(reader, node, name, definition + length + 1, &value);
  }
  if (has_attribute(node, "unit")) {
    struct Dimension unit = unit_attribute(reader, node, "unit");
    if (!value.literal)
      require_unit(reader, line_of_attribute(node, "value"), "the value of the constant", value, unit);
    value = (struct Quantity){.node = value.node, .dimension = unit};
  } else if (value.literal) value.factor = (struct NumberFactor){.text = name, .power = 1.0};
  scope_define(reader->scope, name, value, line_of(node));
}

/* Defines m[1], m[2] and m[3] for values="1 2 3" of m. */
static void read_constants(struct Reader *reader, xmlNodePtr node, const char *name) {
  const char *next = attribute(node, "values");
  size_t count = 0;
  if (has_attribute(node, "value"))
    report_at(reader, node, "a <constant> has both value and values; expected one of them");
  check_name_of_list(reader, node, name);
  for (char *text = next_listed(&next); text != NULL; text = next_listed(&next))
    define_constant(reader, node, format_text("%s[%zu]", name, ++count), text);
  if (count == 0) report_at(reader, node, "the constant '%s' has no values; expected numbers", name);
}

static void read_constant(struct Reader *reader, xmlNodePtr node) {
  char *name = name_attribute(reader, node, "name");
  if (name == NULL) return;
  if (has_attribute(node, "values")) read_constants(reader, node, name);
  else define_constant(reader, node, name, NULL);
  if (!has_attribute(node, "value") && !has_attribute(node, "values"))
    report_at(reader, node,
              "<constant> needs the attribute 'value'; expected value=\"...\", or values=\"...\" for name[1], name[2], "
              "...");
}

static Node append_input_rate(struct Reader *reader) {
  const struct VariableList *inputs = &reader->model->inputs;
  const struct Variable *of = &inputs->items[inputs->count - 1];
  struct Variable rate =
      variable_create(format_text("der(%s)", of->name), format_text("time derivative of %s", of->name), of->line);
  rate.start = 0.0;
  rate.dimension = dimension_multiply(of->dimension, unit_of("s"), -1.0);
  Node rated = of->node, node = append_input(reader, rate);
  scope_set_time_derivative(reader->scope, rated, node);
  return node;
}

static double nominal_attribute(struct Reader *reader, xmlNodePtr node, const char *name) {
  double nominal = NAN;
  if (number_attribute(reader, node, name, &nominal) && !(nominal > 0)) {
    report_at(reader, node, "%s is %g; expected a positive number", name, nominal);
    nominal = NAN;
  }
  return nominal;
}

static void read_coordinate(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  struct Variable position = common_attributes(reader, node);
  struct Variable velocity =
      variable_create(name_attribute(reader, node, "velocity"), attribute(node, "velocityDescription"), position.line);
  velocity.dimension = dimension_multiply(position.dimension, unit_of("s"), -1.0);
  velocity.display_unit = display_unit_attribute(reader, node, "velocityDisplayUnit", velocity.dimension);
  if (velocity.name == NULL) velocity.name = copy_text("?");
  overrides_of(reader, node, position.name); /* marks overrides as used; start_expressions.c reads them */
  if (velocity.description == NULL) velocity.description = format_text("velocity of %s", position.name);
  position.start = preliminary_start(node, "start");
  velocity.start = preliminary_start(node, "velocityStart");
  char *fixed = attribute(node, "fixed");
  position.is_fixed = fixed != NULL && (strcmp(fixed, "true") == 0 || strcmp(fixed, "1") == 0);
  position.nominal = nominal_attribute(reader, node, "nominal");
  velocity.nominal = nominal_attribute(reader, node, "velocityNominal");
  int index = (int)model->coordinates.count;
  position.node = scope_symbol(reader->scope, COORDINATE, index, position.name, position.dimension, position.line);
  velocity.node = scope_symbol(reader->scope, VELOCITY, index, velocity.name, velocity.dimension, velocity.line);
  position.line = velocity.line = scope_line(reader->scope, position.line);
  reader->present->number = (size_t)index;
  append_variable(&model->coordinates, position);
  append_variable(&model->velocities, velocity);
  model->prescribed.motions = make_room(model->prescribed.motions, (size_t)index, sizeof *model->prescribed.motions);
  model->prescribed.motions[index] = (struct PrescribedMotion){.is_prescribed = has_attribute(node, "acceleration")};
  model->prescribed.motion_count += model->prescribed.motions[index].is_prescribed;
  model->forces.any |= model->prescribed.motions[index].is_prescribed;
}

/* A displacement has a rate, which is zero too: it lets velocities contribute to the force along the displacement. */
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
}

/* Adds the expression to the sum over displaced positions, at zero displacements to the other. Returns the latter. */
static Node read_energy(struct Reader *reader, xmlNodePtr node, struct Quantity *displaced, struct Quantity *sum,
                        const char *what, unsigned kinds, const char *unit) {
  struct Quantity term = expression_text_of(reader, node, what, kinds);
  require_unit(reader, line_of(node), what, term, unit_of(unit));
  reader->model->prescribed.inputs_move |=
      (kinds & WITH_RATES) != 0 && graph_depends_on(reader->model->graph, term.node, INPUT);
  return add_energy(reader, node, what, term.node, displaced, sum);
}

static void read_kinetic(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  bool is_prescribed;
  Node term = read_energy(reader, node, &model->energies.displaced_kinetic, &model->energies.explicit_kinetic,
                          "the kinetic energy", IN_ENERGY, "J");
  add_term(model, &model->energies.kinetic, term);
  add_term(model, &model->energies.kinetic_energy, energy_of_kinetic_term(model, term, &is_prescribed));
  model->energies.has_prescribed |= is_prescribed;
}

/* Reads the prescribed acceleration of a coordinate. */
static void read_prescribed_motion(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  struct Quantity acceleration = {.node = ZERO};
  if (!expression_attribute(reader, node, "acceleration", IN_PRESCRIBED_MOTION, &acceleration)) return;
  char *name = name_attribute(reader, node, "name");
  const struct Symbol *symbol = name != NULL ? find_coordinate(reader, name) : NULL;
  if (symbol == NULL) return; /* the name was taken, which has been reported */
  const struct Variable *velocity = &model->velocities.items[symbol->index];
  if (velocity->dimension.known)
    require_unit(reader, line_of_attribute(node, "acceleration"), "the acceleration", acceleration,
                 dimension_multiply(velocity->dimension, unit_of("s"), -1.0));
  model->prescribed.motions[symbol->index].acceleration = acceleration.node;
}

static void read_output(struct Reader *reader, xmlNodePtr node) {
  struct Variable output = common_attributes(reader, node);
  char *what = format_text("the output '%s'", output.name);
  definitions_parse_now(reader->definitions, output.name);
  if (!definitions_take(reader->definitions, output.name, node)) {
    struct Quantity value = read_output_value(reader, node, output.name, output.dimension);
    scope_define(reader->scope, output.name, value, output.line);
  }
  if (!output.dimension.known) output.dimension = scope_find(reader->scope, output.name)->dimension;
  /* The output itself stays whole and needs no events, unlike expressions that use its name. */
  Node reported = reader->diagnostics->errors == 0 ? whole_expression_of(reader, node, what, IN_OUTPUT).node : ZERO;
  output.node = without_displacements(reader, output.line, what, reported);
  output.line = scope_line(reader->scope, output.line);
  append_variable(&reader->model->outputs, output);
}

void read_solver(struct Reader *reader, xmlNodePtr node) {
  char *method = attribute(node, "method");
  reader->model->solver.line = scope_line(reader->scope, line_of(node));
  if (reader->has_solver) report_at(reader, node, "the system has a second <solver>; expected one");
  reader->has_solver = true;
  if (method != NULL) reader->model->solver.method = method_named(method);
  double *tolerance = &reader->model->solver.tolerance;
  if (number_attribute(reader, node, "tolerance", tolerance) && !(*tolerance > 0 && *tolerance < 1))
    report_at(reader, node, "tolerance is %g; expected a number between 0 and 1", *tolerance);
  if (*tolerance > 0 && *tolerance < 1e-14)
    report_warning(reader->diagnostics, line_of(node),
                   "tolerance %g is below the rounding error of doubles; expected 1e-14 or more", *tolerance);
  number_attribute(reader, node, "maxStep", &reader->model->solver.max_step);
  double *steps = &reader->model->solver.max_steps;
  if (number_attribute(reader, node, "maxSteps", steps) && !(*steps >= 1 && *steps <= 1e9 && *steps == floor(*steps)))
    report_at(reader, node, "maxSteps is %g; expected a whole number from 1 to 1e9", *steps);
}

void read_experiment(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  if (reader->has_experiment) report_at(reader, node, "the system has a second <experiment>; expected one");
  reader->has_experiment = true;
  number_attribute(reader, node, "startTime", &model->experiment.start_time);
  number_attribute(reader, node, "stopTime", &model->experiment.stop_time);
  if (number_attribute(reader, node, "stepSize", &model->experiment.step_size) && !(model->experiment.step_size > 0))
    report_at(reader, node, "stepSize is %g; expected a positive number", model->experiment.step_size);
  double start = isnan(model->experiment.start_time) ? 0.0 : model->experiment.start_time;
  if (model->experiment.stop_time <= start)
    report_at(reader, node, "stopTime %g is not after startTime %g; expected a later one", model->experiment.stop_time,
              start);
}

/* Appends inputs that are the time derivatives of the last input. */
static void read_input_rates(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  double derivatives = 0;
  if (number_attribute(reader, node, "derivatives", &derivatives) && derivatives != 1 && derivatives != 2)
    report_at(reader, node, "derivatives=\"%g\" of <input> is not possible; expected 1 or 2", derivatives);
  size_t index = model->inputs.count - 1;
  for (int k = 0; k < 2 && derivatives >= k + 1; k++, index++) {
    Node rate = append_input_rate(reader); /* may move the list */
    model->prescribed.input_rates[index] = rate;
  }
}

static void read_input(struct Reader *reader, xmlNodePtr node) {
  struct Variable variable = common_attributes(reader, node);
  const struct Override *overrides = overrides_of(reader, node, variable.name);
  if (override_of_value(overrides) != NULL) { /* read as a definition */
    check_calculated(reader, overrides, node);
    return;
  }
  variable.start = 0.0;
  overridden_number_attribute(reader, node, overrides, "start", &variable.start);
  overridden_number_attribute(reader, node, overrides, "min", &variable.minimum);
  overridden_number_attribute(reader, node, overrides, "max", &variable.maximum);
  check_range(reader, &variable);
  append_input(reader, variable);
  read_input_rates(reader, node);
}

/* Collects the rate of a state under the name der(STATE), which der(...) in parser.c waits for. */
static void collect_rate(struct Reader *reader, xmlNodePtr node) {
  const struct Variable *state = &reader->model->states.items[reader->present->number];
  definitions_add(reader->definitions, format_text("der(%s)", state->name),
                  &(struct NamedExpression){node, "rate", reader->source, NULL});
}

static void read_state(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  struct Variable state = common_attributes(reader, node);
  overrides_of(reader, node, state.name); /* marks overrides as used; start_expressions.c reads them */
  state.start = 0.0;                      /* preliminary, see start_expressions.h */
  state.nominal = nominal_attribute(reader, node, "nominal");
  number_attribute(reader, node, "min", &state.minimum);
  number_attribute(reader, node, "max", &state.maximum);
  reader->present->number = model->states.count;
  state.node = scope_symbol(reader->scope, STATE, (int)model->states.count, state.name, state.dimension, state.line);
  state.line = scope_line(reader->scope, state.line);
  append_variable(&model->states, state);
}

static void read_work(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  if (work_of(model) != NULL) return;
  struct Variable work =
      variable_create(copy_text("nonConservativeWork"), copy_text("work of the non-conservative forces"),
                      scope_line(reader->scope, line_of(node)));
  work.start = 0.0;
  work.dimension = unit_of("J");
  work.is_work = true;
  work.node = graph_symbol(model->graph, STATE, (int)model->states.count, work.name);
  append_variable(&model->states, work);
}

static void read_potential(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  read_energy(reader, node, &model->energies.displaced_potential, &model->energies.potential, "the potential",
              IN_POTENTIAL, "J");
}

static void read_dissipation(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  Node dissipation = read_energy(reader, node, &model->energies.displaced_dissipation, &model->energies.dissipation,
                                 "the dissipation", IN_FORCE, "W");
  if (dissipation != ZERO && !graph_depends_on(model->graph, dissipation, VELOCITY))
    report_warning(reader->diagnostics, line_of(node),
                   "the dissipation has no velocities, and makes no force; expected one such as b*v^2/2");
  size_t count = reader->dissipation_count++;
  reader->dissipations = make_room(reader->dissipations, count, sizeof *reader->dissipations);
  reader->dissipations[count] = (struct Dissipation){dissipation, scope_line(reader->scope, line_of(node))};
  model->forces.any = true;
}

/* The functions that read an element, one per pass; NULL for none. The table is sorted by name. */
struct ElementReaders {
  const char *name;
  ElementReader *declare, *collect, *place, *read, *draw;
  bool is_of_system; /* read in the main file only, ignored in included ones */
};

static const struct ElementReaders elements[] = {
    {"body", number_body, collect_components, read_body, NULL, NULL, false},
    {"bushing", NULL, NULL, NULL, read_bushing, NULL, false},
    {"constant", read_constant, NULL, NULL, NULL, NULL, false},
    {"constraint", declare_constraint, NULL, NULL, read_constraint, NULL, false},
    {"contact", declare_contact, NULL, NULL, read_contact, NULL, false},
    {"coordinate", read_coordinate, NULL, read_start_expressions, read_prescribed_motion, NULL, false},
    {"define", NULL, collect_value, NULL, NULL, NULL, false},
    {"displacement", read_displacement, NULL, NULL, NULL, NULL, false},
    {"dissipation", NULL, NULL, NULL, read_dissipation, NULL, false},
    {"event", NULL, NULL, NULL, read_event, NULL, false},
    {"experiment", read_experiment, NULL, NULL, NULL, NULL, true},
    {"force", NULL, NULL, NULL, read_force, NULL, false},
    {"frame", declare_frame, collect_components, read_body, add_regularization_of_norm, NULL, false},
    {"friction", declare_friction, NULL, NULL, read_friction, NULL, false},
    {"function", declare_function, NULL, NULL, NULL, NULL, false},
    {"gravity", NULL, NULL, NULL, read_gravity, NULL, false},
    {"input", read_input, collect_value, NULL, NULL, NULL, false},
    {"joint", declare_joint, collect_joint, NULL, read_joint, NULL, false},
    {"kinetic", NULL, NULL, NULL, read_kinetic, NULL, false},
    {"line", NULL, NULL, NULL, NULL, read_line, false},
    {"mode", declare_mode, NULL, read_start_of_mode, NULL, NULL, false},
    {"output", NULL, collect_output, NULL, read_output, NULL, false},
    {"parameter", read_parameter, collect_value, NULL, NULL, NULL, false},
    {"particle", number_body, collect_components, read_body, NULL, NULL, false},
    {"point", NULL, collect_components, read_body, NULL, NULL, false},
    {"potential", NULL, NULL, NULL, read_potential, NULL, false},
    {"preset", NULL, NULL, NULL, read_preset, NULL, true},
    {"sample", NULL, NULL, NULL, read_sample, NULL, false},
    {"shape", declare_shape, NULL, place_shape, NULL, NULL, false},
    {"solver", read_solver, NULL, NULL, NULL, NULL, true},
    {"spring", NULL, collect_spring, NULL, read_spring, draw_spring, false},
    {"state", read_state, collect_rate, read_start_of_state, NULL, NULL, false},
    {"stop", declare_stop, NULL, NULL, read_stop, NULL, false},
    {"table", read_table, NULL, NULL, NULL, NULL, false},
    {"task", NULL, NULL, NULL, NULL, read_task, true},
    {"torque", NULL, NULL, NULL, read_torque, NULL, false},
    {"work", read_work, NULL, NULL, NULL, NULL, true},
};

static int compare(const void *name, const void *element) {
  return strcmp(name, ((const struct ElementReaders *)element)->name);
}

void read_element(struct Reader *reader, xmlNodePtr node, enum Pass pass) {
  const struct ElementReaders *element =
      bsearch(node->name, elements, sizeof elements / sizeof *elements, sizeof *elements, compare);
  if (element == NULL || (element->is_of_system && reader->source->outer != NULL)) return;
  ElementReader *const actions[] = {[DECLARATIONS] = element->declare,
                                    [DEFINITIONS] = element->collect,
                                    [POSITIONS] = element->place,
                                    [EXPRESSIONS] = element->read,
                                    [DRAWING] = element->draw};
  if (actions[pass] != NULL) actions[pass](reader, node);
}
