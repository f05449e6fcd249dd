#include "read/stages.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "mechanics/energies.h"
#include "read/expressions/named_functions.h"

static void check_work(const struct Reader *reader) {
  const struct Model *model = reader->model;
  const struct Variable *work = work_of(model);
  if (work != NULL && !model->forces.any && !work_includes_all_forces(model))
    report_error(reader->diagnostics, work->line, "<work/> has no forces; expected a <force> or <dissipation>");
}

static void check_content(const struct Reader *reader) {
  const struct Model *model = reader->model;
  size_t coordinates = model->coordinates.count;
  if (is_motionless(model) && model->outputs.count == 0 && reader->diagnostics->errors == 0)
    report_error(reader->diagnostics, 0,
                 "the system has neither coordinates, nor states, nor outputs; expected a <coordinate>, a <state> or "
                 "an <output>");
  if (coordinates == 0 && (model->mechanism.body_count > 0 || model->displacements.count > 0 ||
                           model->energies.kinetic.node != ZERO || model->forces.any))
    report_error(reader->diagnostics, 0, "masses or forces belong to no coordinate; expected a <coordinate>");
  for (size_t i = 0; i < model->switches.event_count && is_motionless(model); i++)
    report_error(reader->diagnostics, model->switches.events[i].line,
                 "%s needs coordinates or states, which the system lacks; expected a <state>, such as <state "
                 "name=\"clock\" unit=\"s\" rate=\"1\"/>",
                 model->switches.events[i].passage == PASSAGE_SAMPLES ? "a <sample>" : "an <event>");
  if (is_motionless(model) && reader->has_solver)
    report_error(reader->diagnostics, model->solver.line,
                 "a system without coordinates and states has nothing to solve; expected no <solver>");
}

/* True for an element with an index, such as x[2], if one before it comes from the same line of a <for>. */
static bool is_repeated(const struct VariableList *list, size_t i) {
  const struct Variable *own = &list->items[i];
  size_t length = strcspn(own->name, "[");
  for (size_t j = 0; j < i && own->name[length] == '['; j++)
    if (list->items[j].line == own->line && strncmp(list->items[j].name, own->name, length + 1) == 0) return true;
  return false;
}

/* A variable without a unit agrees with all units, so that a forgotten unit hides errors. */
static void warn_without_unit(const struct Reader *reader) {
  const struct Model *model = reader->model;
  const struct VariableList *const lists[] = {&model->parameters, &model->inputs, &model->coordinates,
                                              &model->displacements, &model->states};
  for (size_t list = 0; reader->scope->checks_units && list < 5; list++)
    for (size_t i = 0; i < lists[list]->count; i++)
      if (lists[list]->items[i].unit == NULL && lists[list]->items[i].type == TYPE_REAL &&
          !lists[list]->items[i].is_work && !is_repeated(lists[list], i) &&
          !(lists[list] == &model->inputs && is_input_rate(model, i)))
        report_warning(reader->diagnostics, lists[list]->items[i].line,
                       "'%s' has no unit, so that units are not checked where it is used; expected one, or "
                       "unit=\"1\"",
                       lists[list]->items[i].name);
}

/* Returns a flag per node: set for nodes that some quantity with displacements depends on. */
static bool *mark_displaced(const struct Model *model) {
  Node *targets = allocate(4 * model->mechanism.body_count + 3, sizeof *targets);
  size_t count = 0;
  for (size_t i = 0; i < model->mechanism.body_count; i++)
    for (int component = 0; component < 4; component++)
      targets[count++] = model->mechanism.bodies[i].displaced[component];
  targets[count++] = model->energies.displaced_kinetic.node;
  targets[count++] = model->energies.displaced_potential.node;
  targets[count++] = model->energies.displaced_dissipation.node;
  bool *marks = allocate(model->graph->count, sizeof *marks);
  graph_mark(model->graph, targets, count, marks);
  return marks;
}

static void warn_of_displacements(const struct Reader *reader) {
  const struct VariableList *displacements = &reader->model->displacements;
  bool *marks = displacements->count > 0 ? mark_displaced(reader->model) : NULL;
  for (size_t i = 0; i < displacements->count; i++)
    if (!marks[displacements->items[i].node])
      report_warning(reader->diagnostics, displacements->items[i].line,
                     "the displacement '%s' moves nothing, so its force is 0; expected it in a position, an angle "
                     "or a potential",
                     displacements->items[i].name);
}

static void warn_of_inertia(const struct Reader *reader, const struct Body *body, const char *what, Node inertia,
                            const double *values) {
  /* A body in a frame may consist of only moments of inertia, such as the first link of a robot. */
  bool may_vanish = graph_is_constant(reader->model->graph, inertia) || body->is_in_frame;
  if (may_vanish ? values[inertia] >= 0 : values[inertia] > 0) return;
  report_warning(reader->diagnostics, body->line, "the %s of '%s' is %g at the start values; expected a positive one",
                 what, body->name, values[inertia]);
}

/* True if a symmetric matrix is positive semidefinite: all principal minors are nonnegative (Sylvester). */
static bool is_semidefinite(double m[3][3]) {
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3;
    if (m[i][i] < 0 || m[i][i] * m[j][j] < m[i][j] * m[i][j]) return false;
  }
  double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[1][2]) -
                       m[0][1] * (m[0][1] * m[2][2] - m[1][2] * m[0][2]) +
                       m[0][2] * (m[0][1] * m[1][2] - m[1][1] * m[0][2]);
  return determinant >= 0;
}

/*
 * True if the principal moments of inertia are possible: none is negative or exceeds the sum of the other two. One
 * percent of the trace is allowed for rounded numbers in files. trace/2 minus a principal moment is the second moment
 * of the mass along that axis, which is nonnegative.
 */
static bool tensor_is_of_a_body(double tensor[3][3]) {
  double moments[3][3];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      moments[i][j] = (i == j ? 0.51 * (tensor[0][0] + tensor[1][1] + tensor[2][2]) : 0) - tensor[i][j];
  return is_semidefinite(moments);
}

/*
 * Warns of an inertia tensor that violates the triangle inequality of principal moments. Skipped if a diagonal element
 * is missing: authors of bodies that rotate about one axis give only that moment.
 */
static void warn_of_tensor(const struct Reader *reader, const struct Body *body, const double *values) {
  double tensor[3][3];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) tensor[i][j] = values[body->tensor.row[i].along[j]];
  for (int i = 0; i < 3; i++)
    if (body->tensor.row[i].along[i] == ZERO) return;
  if (tensor_is_of_a_body(tensor)) return;
  report_warning(reader->diagnostics, body->line,
                 "no body can have the moments of inertia of '%s' at the start values: a principal moment is negative, "
                 "or larger than the other two together; expected others",
                 body->name);
}

/* Reports quaternions that are zero at the start: their constraint, norm^2 - 1 = 0, is then -1. */
static void check_quaternions(const struct Reader *reader, const double *values) {
  const struct Model *model = reader->model;
  for (size_t i = 0; i < model->constraints.count; i++) {
    const struct Variable *constraint = &model->constraints.items[i];
    for (size_t k = 0; k < model->mechanism.regularization_count; k++)
      if (model->mechanism.regularizations[k].constraint == constraint->node && values[constraint->node] == -1)
        report_error(reader->diagnostics, constraint->line,
                     "the quaternion of %.*s is 0 at the start values; expected a norm of 1, such as start=\"1\" of "
                     "its first coordinate",
                     (int)(strrchr(constraint->name, '.') - constraint->name), constraint->name);
  }
}

static void check_expectations(const struct Reader *reader, const double *values) {
  for (size_t i = 0; i < reader->expectation_count; i++) {
    const struct Expectation *expected = &reader->expectations[i];
    double value = values[expected->node];
    if (expected->is_size ? value > 0.0 && isfinite(value) : !(value < 0.0)) continue;
    static const char message[] = "%s is %g at the start values; expected %s";
    const char *right = expected->is_size ? "a number above 0" : "none below 0";
    if (expected->is_required) report_error(reader->diagnostics, expected->line, message, expected->what, value, right);
    else report_warning(reader->diagnostics, expected->line, message, expected->what, value, right);
  }
}

/* Returns the values of all nodes at the start, where piecewise functions have the pieces of the start. */
static double *values_at_start(const struct Model *model) {
  enum { ROUNDS = 4 }; /* pieces within pieces follow one another */
  const struct Switches *switches = &model->switches;
  double *symbols = start_values(model), *values = graph_evaluate(model->graph, symbols);
  bool again = switches->branch_count > 0;
  for (int round = 0; round < ROUNDS && again; round++) {
    again = false;
    for (size_t i = 0; i < switches->branch_count; i++) {
      double sign = values[switches->branches[i].indicator];
      double *mode = &symbols[model->graph->vertices[switches->branches[i].mode].left];
      again |= *mode != (double)((sign > 0.0) - (sign < 0.0));
      *mode = (double)((sign > 0.0) - (sign < 0.0));
    }
    if (!again) break;
    release(values);
    values = graph_evaluate(model->graph, symbols);
  }
  release(symbols);
  return values;
}

static void warn_at_start(const struct Reader *reader) {
  const struct Model *model = reader->model;
  double *values = values_at_start(model);
  for (size_t i = 0; i < model->mechanism.body_count; i++) {
    const struct Body *body = &model->mechanism.bodies[i];
    warn_of_inertia(reader, body, "mass", body->mass.node, values);
    warn_of_inertia(reader, body, "inertia", body->inertia.node, values);
    if (body->is_in_frame) warn_of_tensor(reader, body, values);
  }
  check_quaternions(reader, values);
  check_expectations(reader, values);
  warn_outside_domains(&reader->scope->requirements, model->graph, values, reader->diagnostics);
  release(values);
}

/* Returns the values of all nodes at the start, with these velocities for even and for odd indices. */
static double *values_at_velocities(const struct Model *model, double even, double odd) {
  double *symbols = start_values(model);
  for (size_t i = 0; i < model->velocities.count; i++)
    symbols[model->graph->vertices[model->velocities.items[i].node].left] = i % 2 == 0 ? even : odd;
  return graph_evaluate(model->graph, symbols);
}

/*
 * Warns of dissipations that decrease from rest and so accelerate the motion. The average over opposite velocities
 * cancels terms that are linear in them, which are forces. odd = -1 makes a damper between two neighbouring coordinates
 * move.
 */
static void warn_of_dissipation(const struct Reader *reader, double odd) {
  const struct Model *model = reader->model;
  double *rest = values_at_velocities(model, 0, 0), *forth = values_at_velocities(model, 1, odd),
         *back = values_at_velocities(model, -1, -odd);
  long reported = 0;
  for (size_t i = 0; i < reader->dissipation_count; i++) {
    struct Dissipation *dissipation = &reader->dissipations[i];
    Node node = dissipation->node;
    double growth = (forth[node] - rest[node] + (back[node] - rest[node])) / 2;
    double rounding = 1e-12 * (fabs(forth[node]) + fabs(back[node]) + fabs(rest[node]));
    if (!(growth < -rounding)) continue;
    if (dissipation->line != reported)
      report_warning(reader->diagnostics, dissipation->line,
                     "the dissipation is %g for velocities of +-1 at the start values, so that it accelerates the "
                     "motion; expected "
                     "a positive one, such as b*v^2/2",
                     growth);
    reported = dissipation->line;
    dissipation->node = ZERO; /* no second warning */
  }
}

/* Warns of functions that are never called. Included files may contain functions for other systems. */
static void warn_of_functions(const struct Reader *reader) {
  const struct Names *functions = reader->scope->functions;
  for (size_t i = 0; i < functions->capacity; i++) {
    const struct NamedFunction *function = functions->slots[i].meaning;
    if (function != NULL && !function->is_used && *function->prefix == '\0')
      report_warning(reader->diagnostics, function->line,
                     "nothing calls the function '%s', so that its expression is not checked; call it, or delete it",
                     function->name);
  }
}

void check_system(struct Reader *reader) {
  check_content(reader);
  check_moving_states(reader);
  check_work(reader);
  if (reader->diagnostics->errors > 0) return;
  warn_of_functions(reader);
  warn_without_unit(reader);
  warn_at_start(reader);
  warn_of_events(reader);
  warn_of_displacements(reader);
  if (reader->dissipation_count == 0) return;
  warn_of_dissipation(reader, 1);
  warn_of_dissipation(reader, -1);
}
