/*
 * Adjoints by reverse mode. The weighted sum s = w^T dx/dt + r^T y of state derivatives and outputs depends on the
 * known values x, and on accelerations and forces a, which solve R = K a - b = 0. By the implicit function theorem
 *
 *     K lambda = (ds/da)^T,   grad s = ds/dx - lambda^T dR/dx   at constant a and lambda,
 *
 * where K is symmetric, so that its factors serve. Each term is one reverse sweep. So all elements of the gradient
 * cost a small multiple of one evaluation and one solution, however many parameters there are. A. Griewank, A.
 * Walther: Evaluating Derivatives, 2nd ed., 2008, section 3.2.
 */
#include "program/expressions/weighted_gradient.h"

#include "algebra/differentiate.h"
#include "algebra/node_list.h"
#include "algebra/simplify.h"
#include "base/memory.h"

/* The kinds of symbols that a gradient has elements for, as bits. */
enum { KNOWN_KINDS = 1 << COORDINATE | 1 << VELOCITY | 1 << STATE | 1 << INPUT | 1 << PARAMETER | 1 << TIME };

/* A sum of expressions times weights. */
struct WeightedSum {
  struct NodeList targets, weights;
};

static void append_term(struct WeightedSum *sum, Node target, Node weight) {
  append_node(&sum->targets, target);
  append_node(&sum->weights, weight);
}

static bool is_symmetric(const struct Inertia *inertia) {
  for (size_t i = 0; i < inertia->block_count; i++)
    if (inertia->blocks[i].force_count > 0) return false;
  return true;
}

/* Returns the outputs and the rates of the first-order states, weighted by their seeds. */
static struct WeightedSum weighted_results(struct Graph *graph, const struct Equations *equations,
                                           const struct Interface *interface, const Node *result) {
  struct WeightedSum sum = {0};
  for (size_t i = 0; i < interface->count; i++) {
    const struct ScalarVariable *entry = &interface->variables[i].entry;
    if (entry->kind != VARIABLE_RESULT || !is_unknown(entry)) continue;
    char *name = format_text("d %s", entry->name);
    append_term(&sum, result[entry->index], graph_symbol(graph, SEED_RESULT, (int)entry->index, name));
  }
  for (size_t i = 0; i < equations->rates.count; i++)
    append_term(&sum, equations->rates.nodes[i],
                graph_symbol(graph, SEED_STATE, (int)i, format_text("d rate %zu", i + 1)));
  return sum;
}

/*
 * Appends -lambda^T R, or explicit accelerations with their weights. Blocks that are solved at run time have symbols
 * for lambda. The weights stay constant while the gradient is taken.
 */
static void append_accelerations(struct WeightedSum *sum, struct Graph *graph, const struct Model *model,
                                 const struct Equations *equations, const Node *seeds,
                                 struct WeightedGradient *gradient) {
  size_t n = equations->count, rows = row_count(equations);
  for (size_t i = 0; i < n && equations->explicit_form; i++)
    append_term(sum, equations->acceleration[i], gradient->right_side[i]);
  if (equations->explicit_form) return;
  inertia_solve(graph, equations->inertia, gradient->right_side, gradient->multiplier);
  for (size_t i = 0; i < rows; i++) {
    Node symbol = i < n ? model->unknowns.accelerations[i] : model->unknowns.forces[i - n];
    if (is_looped(equations, i)) gradient->multiplier[i] = replacement_of(graph, seeds, symbol);
    append_term(sum, equations->residual[i], negate(graph, gradient->multiplier[i]));
  }
}

/* Returns the index of a symbol's element in the gradient. */
static size_t row_of(const struct Model *model, const struct Interface *interface, const struct Symbol *symbol) {
  size_t index = (size_t)symbol->index, states = interface->state_count;
  switch ((int)symbol->kind) {
  case COORDINATE:
  case VELOCITY:
  case STATE: return state_slot(model->coordinates.count, symbol);
  case INPUT: return states + index;
  case PARAMETER: return states + model->inputs.count + index;
  default: return states + model->inputs.count + model->parameters.count + model->switches.mode_count;
  }
}

static void fill_elements(struct Graph *graph, const struct Model *model, const struct Interface *interface,
                          const struct WeightedSum *sum, const Node *seeds, struct WeightedGradient *gradient) {
  size_t n = model->coordinates.count;
  gradient->count =
      interface->state_count + model->inputs.count + model->parameters.count + model->switches.mode_count + 1;
  gradient->elements = allocate(gradient->count, sizeof(Node));
  struct Gradient found =
      weighted_gradient(graph, sum->targets.nodes, sum->weights.nodes, sum->targets.count, KNOWN_KINDS);
  for (size_t i = 0; i < found.count; i++)
    gradient->elements[row_of(model, interface, graph_symbol_of(graph, found.symbols[i]))] = found.values[i];
  for (size_t i = 0; i < n; i++) {
    Node *by_velocity = &gradient->elements[n + i];
    *by_velocity = add(graph, *by_velocity, replacement_of(graph, seeds, model->coordinates.items[i].node));
  }
}

struct WeightedGradient *weighted_gradient_create(const struct Model *model, const struct Equations *equations,
                                                  const struct Interface *interface, const Node *result,
                                                  const Node *seeds) {
  struct Graph *graph = model->graph;
  size_t rows = row_count(equations);
  if (!is_symmetric(equations->inertia)) return NULL;
  struct WeightedGradient *gradient = allocate(1, sizeof *gradient);
  gradient->right_side = allocate(rows, sizeof(Node));
  gradient->multiplier = allocate(rows, sizeof(Node));
  struct WeightedSum sum = weighted_results(graph, equations, interface, result);
  weighted_gradient_of(graph, sum.targets.nodes, sum.weights.nodes, sum.targets.count, ACCELERATION, rows,
                       gradient->right_side);
  for (size_t i = 0; i < equations->count; i++)
    gradient->right_side[i] =
        add(graph, gradient->right_side[i], replacement_of(graph, seeds, model->velocities.items[i].node));
  append_accelerations(&sum, graph, model, equations, seeds, gradient);
  fill_elements(graph, model, interface, &sum, seeds, gradient);
  return gradient;
}
