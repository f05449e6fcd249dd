#include "read/context/constraint_checks.h"

#include "algebra/differentiate.h"
#include "algebra/polynomials/rational.h"
#include "base/memory.h"

static bool is_linear_in_velocities(struct Graph *graph, Node node) {
  struct Gradient slopes = gradient_by_kinds(graph, node, KIND(VELOCITY));
  bool is_linear = true;
  for (size_t i = 0; i < slopes.count; i++) is_linear &= !graph_depends_on(graph, slopes.values[i], VELOCITY);
  return is_linear;
}

/* True if the constraint prescribes a motion, also at zero velocities. */
static bool is_moving(const struct Model *model, Node constraint) {
  struct Graph *graph = model->graph;
  if (!graph_depends_on(graph, constraint, VELOCITY))
    return graph_depends_on(graph, constraint, TIME) || graph_depends_on(graph, constraint, INPUT) ||
           graph_depends_on(graph, constraint, STATE);
  Node *at_rest = allocate(graph->symbol_count, sizeof *at_rest), value;
  for (size_t i = 0; i < graph->symbol_count; i++)
    at_rest[i] = graph->symbols[i].kind == VELOCITY ? ZERO : graph->symbols[i].node;
  substitute(graph, &constraint, 1, at_rest, &value);
  return simplify_fraction(graph, value) != ZERO;
}

/* Returns what gives the input as many time derivatives as a constraint needs. */
static char *remedy_for_input(const struct Model *model, size_t input, size_t needed) {
  if (!is_input_rate(model, input)) return format_text("derivatives=\"%zu\" of this <input>", needed);
  if (needed == 1 && !is_input_rate(model, input - 1))
    return format_text("derivatives=\"2\" of the <input> '%s'", model->inputs.items[input - 1].name);
  return copy_text("the <input> itself in place of its derivative");
}

/*
 * Reports inputs with too few time derivatives. The constraint on accelerations contains second derivatives of inputs
 * in holonomic constraints, and first ones in those of velocities.
 */
static void require_rates(const struct Reader *reader, const struct Variable *constraint) {
  const struct Model *model = reader->model;
  size_t needed = graph_depends_on(model->graph, constraint->node, VELOCITY) ? 1 : 2;
  struct Gradient gradient = gradient_by_kinds(model->graph, constraint->node, KIND(INPUT));
  for (size_t i = 0; i < gradient.count; i++) {
    size_t input = (size_t)graph_symbol_of(model->graph, gradient.symbols[i])->index;
    if (input_rate_count(model, input) >= needed) continue;
    report_error(reader->diagnostics, constraint->line,
                 "the constraint '%s' needs the %s derivative of '%s'; expected %s", constraint->name,
                 needed == 1 ? "time" : "second", model->inputs.items[input].name,
                 remedy_for_input(model, input, needed));
  }
}

void check_constraint(struct Reader *reader, const struct Variable *constraint) {
  struct Model *model = reader->model;
  const struct Graph *graph = model->graph;
  if (!graph_depends_on(graph, constraint->node, COORDINATE) && !graph_depends_on(graph, constraint->node, VELOCITY))
    report_error(reader->diagnostics, constraint->line,
                 "the constraint '%s' contains no coordinate; expected an expression of coordinates that is 0 at all "
                 "times, or no constraint where it is always 0",
                 constraint->name);
  else if (!is_linear_in_velocities(model->graph, constraint->node))
    report_error(reader->diagnostics, constraint->line,
                 "the constraint '%s' is not linear in the velocities; expected one of coordinates and time, or one "
                 "linear in the velocities, as of rolling without slipping",
                 constraint->name);
  else if (is_moving(model, constraint->node)) model->prescribed.constraint = constraint;
  if (graph_depends_on(graph, constraint->node, INPUT)) require_rates(reader, constraint);
}
