/*
 * A system is read in five passes over its elements, see enum Pass:
 *
 *   DECLARATIONS defines constants, and symbols for parameters, inputs, coordinates, states, constraints, contacts
 * and frictions, while expansion.c makes the list of elements. DEFINITIONS collects the named expressions, which
 * resolution.c then parses in topological order. POSITIONS reads bodies, frames, shapes and start values.
 * EXPRESSIONS reads energies, forces, constraints, events and outputs, which may use all names. DRAWING reads lines
 * that are drawn, in a graph of their own.
 *
 * Symbols whose indices depend on counts follow the first pass: modes, accelerations, constraint forces and reactions.
 * Modes that expressions add come later. After EXPRESSIONS switching functions and frictions are completed and the
 * whole system is checked.
 */
#include "read/reader.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "model/prescribed_frictions.h"
#include "model/resting_velocities.h"
#include "read/stages.h"
#include "read/context/attributes.h"
#include "read/context/includes.h"
#include "read/context/variables.h"
#include "read/elements/definition_order.h"
#include "read/elements/start_expressions.h"
#include "read/elements/switching_reader.h"
#include "names/definitions.h"
#include "names/words.h"
#include "robots/robot_system.h"
#include "read/shapes/drawn_lines.h"
#include "read/shapes/shape_meshes.h"
#include "read/space/frames.h"
#include "xml/xml.h"

/* Adds the symbols of accelerations and sets the time derivatives of time, coordinates and velocities. */
static void relate_to_time(struct Model *model, struct Scope *scope) {
  size_t n = model->coordinates.count;
  model->unknowns.accelerations = allocate(n, sizeof *model->unknowns.accelerations);
  model->forces.along = allocate(n, sizeof *model->forces.along);
  scope_set_time_derivative(scope, model->time, ONE);
  for (size_t i = 0; i < n; i++) {
    char *name = format_text("der(%s)", model->velocities.items[i].name);
    model->unknowns.accelerations[i] =
        scope_symbol(scope, ACCELERATION, (int)i, name, model->velocities.items[i].dimension, 0);
    scope_set_time_derivative(scope, model->coordinates.items[i].node, model->velocities.items[i].node);
    scope_set_time_derivative(scope, model->velocities.items[i].node, model->unknowns.accelerations[i]);
  }
}

/* Appends the reaction force along a variable, with its name and unit. */
static void append_reaction(struct Model *model, struct Scope *scope, const struct Variable *along, const char *what) {
  struct Variable force =
      variable_create(format_text("%s.force", along->name), format_text("%s %s", what, along->name), along->line);
  force.dimension = dimension_multiply(unit_of("J"), along->dimension, -1.0);
  force.node = scope_symbol(scope, REACTION, (int)model->reactions.count, force.name, force.dimension, force.line);
  append_variable(&model->reactions, force);
}

static void append_reactions(struct Model *model, struct Scope *scope) {
  for (size_t i = 0; i < model->displacements.count; i++)
    append_reaction(model, scope, &model->displacements.items[i], "force of reaction along");
  for (size_t i = 0; i < model->coordinates.count; i++) {
    if (!model->prescribed.motions[i].is_prescribed) continue;
    model->prescribed.motions[i].reaction = model->reactions.count;
    append_reaction(model, scope, &model->coordinates.items[i], "driving force of");
  }
}

/*
 * Returns the unit of a constraint's force before its expression is read. It is unknown if the constraint may be
 * one of velocities, by its unit such as m/s or A.
 */
static struct Dimension early_force_dimension(const struct Variable *constraint) {
  const double *exponent = constraint->dimension.exponent;
  bool is_open = exponent[SECOND] < 0 || exponent[AMPERE] != 0;
  return is_open && !constraint->is_of_velocities ? dimension_unknown : constraint_force_dimension(constraint);
}

/* Adds symbols for the forces of the constraints. Their indices follow those of the accelerations. */
static void declare_constraint_forces(struct Model *model, struct Scope *scope) {
  model->unknowns.forces = allocate(model->constraints.count, sizeof *model->unknowns.forces);
  for (size_t i = 0; i < model->constraints.count; i++) {
    const struct Variable *constraint = &model->constraints.items[i];
    char *name = constraint_force_name(constraint);
    struct Dimension dimension = early_force_dimension(constraint);
    int index = (int)(model->coordinates.count + i);
    model->unknowns.forces[i] = scope_symbol(scope, ACCELERATION, index, name, dimension, 0);
    struct Quantity force = {.node = whole_constraint_force(model, i), .dimension = dimension};
    if (constraint->force_share == ZERO) scope_define(scope, name, force, constraint->line);
  }
}

static void check_definitions_used(struct Reader *reader) {
  for (size_t i = 0; i < reader->options->definition_count; i++)
    if (!reader->definition_used[i])
      report_error(reader->diagnostics, 0, "-D %s: there is no <constant> of this name; expected an existing name",
                   reader->options->definitions[i]);
}

static struct Model *model_create(void) {
  struct Model *model = allocate(1, sizeof *model);
  model->graph = graph_create();
  model->solver = (struct SolverChoice){.tolerance = NAN, .max_step = NAN, .max_steps = NAN};
  model->experiment = (struct Experiment){NAN, NAN, NAN};
  return model;
}

/* Returns a scope with the names that every system has. */
static struct Scope *language_of(struct Model *model, struct Diagnostics *diagnostics) {
  struct Scope *scope = scope_create(model->graph, diagnostics);
  scope->model = model;
  define_language(scope);
  /* Authors write sin(2*time) and mean 2 rad/s, so time agrees with any unit. */
  model->time = scope_symbol(scope, TIME, 0, "time", dimension_unknown, 0);
  return scope;
}

static void read_drawing(struct Reader *reader) {
  if (reader->diagnostics->errors > 0 || !has_drawing(reader)) return;
  struct Scope *scope = begin_drawing(reader);
  read_expanded(reader, DRAWING);
  end_drawing(reader, scope);
}

static void read_system(struct Reader *reader, xmlNodePtr root) {
  reader->model->name = attribute(root, "name");
  reader->model->description = attribute(root, "description");
  reader->model->origin = (struct Origin){attribute(root, "author"), attribute(root, "version"),
                                          attribute(root, "copyright"), attribute(root, "license")};
  expand(reader, root);
  check_definitions_used(reader);
  check_overrides(reader);
  number_modes(reader);
  relate_to_time(reader->model, reader->scope);
  declare_constraint_forces(reader->model, reader->scope);
  append_reactions(reader->model, reader->scope);
  read_expanded(reader, DEFINITIONS);
  resolve_definitions(reader);
  read_expanded(reader, POSITIONS);
  evaluate_start_expressions(reader);
  read_expanded(reader, EXPRESSIONS);
  if (reader->options->pull && reader->model->coordinates.count > 0) add_pointer_interaction(reader);
  undisplace_branches(reader);
  if (reader->diagnostics->errors == 0) {
    find_prescribed_frictions(reader->model);
    add_sliding_forces_in_planes(reader);
  }
  complete_friction_forces(reader);
  if (reader->diagnostics->errors == 0) replace_resting_velocities(reader->model);
  reader->model->forces.any |= reader->model->prescribed.inputs_move;
  check_system(reader);
  warn_of_coarse_meshes(reader);
  if (graph_limit(reader->model->graph) != NULL && reader->diagnostics->errors == 0)
    report_error(reader->diagnostics, 0, "the system is too large: %s; expected fewer or shorter repetitions",
                 graph_limit(reader->model->graph));
  read_drawing(reader);
}

/* Converts the document of a robot to that of a system. Returns NULL after reporting errors. */
static xmlDocPtr system_by_options(xmlDocPtr document, const struct ReaderOptions *options,
                                   struct Diagnostics *diagnostics) {
  static const struct RobotOptions none;
  if (is_robot(document))
    return system_of_robot(document, options->robot != NULL ? options->robot : &none, diagnostics);
  if (options->robot == NULL) return document;
  report_error(diagnostics, 0,
               "options such as base and ground are for robots; expected a file that begins with <robot> or <mujoco>");
  xmlFreeDoc(document);
  return NULL;
}

/* Reads a system, or a linearization with its system. depth: 1 for the system of a linearization. */
static struct Model *read_file(const char *path, const struct ReaderOptions *options, struct Diagnostics *diagnostics,
                               int depth, struct Scope **scope) {
  struct Diagnostics local = {.file = path, .noted = diagnostics->noted};
  struct Model *model = NULL;
  xmlDocPtr document = xml_load(path, &local);
  if (document != NULL) document = system_by_options(document, options, &local);
  xmlNodePtr root = document != NULL ? xmlDocGetRootElement(document) : NULL;
  if (root != NULL && is_element(root, "linearization")) {
    char *original = depth == 0 ? linearized_path(root, path) : NULL;
    if (depth > 0)
      report_error(&local, line_of(root), "the file linearizes another linearization; expected the file of a <system>");
    else if (original != NULL) {
      model = read_file(original, options, &local, depth + 1, scope);
      if (model != NULL) read_linearization(model, *scope, root, &local);
    }
  } else if (root != NULL) {
    model = model_create();
    model->lines = local.noted;
    *scope = language_of(model, &local);
    if (depth == 0 && !options->linearize) (*scope)->switches = &model->switches;
    struct Reader reader = {.model = model, .scope = *scope, .diagnostics = &local, .options = options};
    includes_begin(&reader, path, root);
    reader.bodies = names_create();
    reader.definitions = (*scope)->definitions = definitions_create();
    reader.definition_used = allocate(options->definition_count, sizeof *reader.definition_used);
    frames_begin(&reader);
    read_system(&reader, root);
    includes_end(&reader);
    (*scope)->definitions = NULL;
  }
  if (model != NULL && (options->point_count > 0 || options->linearize) && depth == 0 && local.errors == 0)
    apply_point(model, *scope, options->point, options->point_count, &local);
  xmlFreeDoc(document);
  diagnostics->errors += local.errors;
  return local.errors == 0 ? model : NULL;
}

struct Model *model_read(const char *path, const struct ReaderOptions *options, struct Diagnostics *diagnostics) {
  struct Scope *scope = NULL;
  diagnostics->noted = allocate(1, sizeof *diagnostics->noted);
  diagnostics->noted->own = path;
  struct Model *model = read_file(path, options, diagnostics, 0, &scope);
  if (model == NULL || options->solver == NULL) return model;
  model->solver.method = method_named(options->solver);
  if (model->solver.method != NULL) return model;
  char *names = method_names();
  report_error(diagnostics, 0, "--solver %s is not known; expected %s", options->solver, names);
  return NULL;
}
