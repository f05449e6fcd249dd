#include "interface/summary.h"

#include <string.h>

#include "algebra/differentiate.h"
#include "algebra/formula.h"
#include "algebra/polynomials/rational.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "base/sorting.h"
#include "mechanics/switching.h"

static void add_name(struct NodeNames *names, Node node, const char *name) {
  if (names->of[node] != NULL) return;
  names->of[node] = name;
  names->named[names->named_count++] = node;
}

/* Names the nodes of the variables, with and without the modes of branches. Numbers and symbols need no name. */
static void add_names(struct NodeNames *names, const struct Model *model, const struct VariableList *list) {
  const struct Graph *graph = model->graph;
  for (size_t i = 0; i < list->count && names->named_count < SHOWN_LIMIT; i++) {
    Node node = list->items[i].node;
    if (graph->vertices[node].operation == SYMBOL || graph_is_constant(graph, node) || names->of[node] != NULL)
      continue;
    add_name(names, node, list->items[i].name);
    add_name(names, as_written(model, node), list->items[i].name);
    if (list->items[i].shown != ZERO) add_name(names, list->items[i].shown, list->items[i].name);
  }
}

/* Returns the names of the first calculated parameters and definitions. Linearized equations have no definitions. */
static struct NodeNames author_names(const struct Model *model) {
  const struct Graph *graph = model->graph;
  for (size_t i = 0; i < model->definitions.count; i++) /* creates all nodes before they are counted */
    as_written(model, model->definitions.items[i].node);
  for (size_t i = 0; i < model->calculated.count; i++) as_written(model, model->calculated.items[i].node);
  struct NodeNames names = {.of = allocate(graph->count, sizeof *names.of), .count = graph->count};
  names.named = allocate(SHOWN_LIMIT + 2, sizeof *names.named);
  add_names(&names, model, &model->calculated);
  if (!model->linearized) add_names(&names, model, &model->definitions);
  return names;
}

/* Returns a constraint as it is while it holds: the gap of a closed contact, the velocity of a friction that sticks. */
static Node shown_constraint(const struct Model *model, size_t i) {
  const struct Switches *switches = &model->switches;
  for (size_t k = 0; k < switches->contact_count; k++)
    if (switches->contacts[k].constraint == i) return switches->contacts[k].gap;
  for (size_t k = 0; k < switches->friction_count; k++)
    if (switches->frictions[k].constraint == i) return switches->frictions[k].velocity;
  return model->constraints.items[i].node;
}

/* Returns K a for all rows; NULL if there are no trees, whose K is not formed. */
static Node *product_of_trees(const struct Model *model, const struct Equations *equations) {
  const struct Inertia *inertia = equations->inertia;
  if (equations->explicit_form || !inertia_has_trees(inertia)) return NULL;
  Node *unknowns = allocate(row_count(equations), sizeof *unknowns);
  Node *product = allocate(row_count(equations), sizeof *product);
  for (size_t i = 0; i < row_count(equations); i++) unknowns[i] = unknown_of_row(model, i);
  inertia_add_product(model->graph, inertia, unknowns, product);
  return product;
}

/* Returns K_ij; the force of a contact is 0 while it is open, so that the element for a closed one stands for both. */
static Node shown_element(const struct Model *model, const struct Equations *equations, size_t i, size_t j) {
  Node element = inertia_element(equations->inertia, i, j);
  for (size_t k = 0; k < model->switches.contact_count; k++) {
    const struct Contact *contact = &model->switches.contacts[k];
    if (equations->count + contact->constraint == j)
      element = substitute_symbol(model->graph, element, contact->mode, ONE);
  }
  return element;
}

/* Returns row i of M a + J^T F, or the acceleration itself. */
static Node inertial_side(const struct Model *model, const struct Equations *equations, const Node *product, size_t i) {
  struct Graph *graph = model->graph;
  if (equations->explicit_form) return model->unknowns.accelerations[i];
  const struct InertiaBlock *block = inertia_block_of(equations->inertia, i);
  Node sum = ZERO;
  if (block->tree != NULL) return as_written(model, product[i]);
  for (size_t k = 0; k < block->count; k++) {
    Node mass = shown_element(model, equations, i, block->coordinates[k]);
    sum = add(graph, sum, multiply(graph, mass, unknown_of_row(model, block->coordinates[k])));
  }
  const struct Elements *loads = &equations->constraints->nonsymmetric; /* frictions that depend on forces */
  for (size_t k = 0; k < loads->count; k++) {
    if (loads->positions[k].column != i) continue;
    sum = add(graph, sum, constraint_force_along(graph, loads, k, model->unknowns.forces));
  }
  return as_written(model, sum);
}

struct Summary *summary_create(const struct Model *model, const struct Equations *equations) {
  struct Graph *graph = model->graph;
  struct Summary *summary = allocate(1, sizeof *summary);
  struct NodeNames names = author_names(model);
  Node lagrangian = subtract(graph, model->energies.kinetic.node, model->energies.potential.node);
  *summary = (struct Summary){
      .names = names,
      .lagrangian_kinetic = as_written(model, model->energies.kinetic.node),
      .kinetic = as_written(model, equations->kinetic),
      .potential = as_written(model, model->linearized ? equations->potential : model->energies.potential.node),
      .power = as_written(model, equations->stated_power),
      .is_autonomous = !graph_depends_on(graph, lagrangian, STATE) &&
                       simplify_fraction(graph, derivative_by(graph, lagrangian, model->time)) == ZERO,
      .constraint_count = smaller(model->constraints.count, SHOWN_LIMIT),
      .motion_count = smaller(equations->count, SHOWN_LIMIT),
      .reaction_count = smaller(model->reactions.count, SHOWN_LIMIT),
      .rate_count = smaller(model->states.count, SHOWN_LIMIT),
      .output_count = smaller(model->outputs.count, SHOWN_LIMIT)};
  summary->inertial = allocate(summary->motion_count, sizeof(Node));
  summary->right_side = allocate(summary->motion_count, sizeof(Node));
  summary->outputs = allocate(summary->output_count, sizeof(Node));
  const Node *product = product_of_trees(model, equations);
  for (size_t i = 0; i < summary->motion_count; i++) {
    summary->inertial[i] = inertial_side(model, equations, product, i);
    summary->right_side[i] = as_written(model, equations->right_side[i]);
  }
  summary->constraints = allocate(summary->constraint_count, sizeof(Node));
  for (size_t i = 0; i < summary->constraint_count; i++)
    summary->constraints[i] = as_written(model, shown_constraint(model, i));
  summary->reactions = allocate(summary->reaction_count, sizeof(Node));
  for (size_t i = 0; i < summary->reaction_count; i++)
    summary->reactions[i] = as_written(model, equations->reactions[i]);
  summary->rates = allocate(summary->rate_count, sizeof(Node));
  for (size_t i = 0; i < summary->rate_count; i++) {
    const struct Variable *state = &model->states.items[i];
    bool is_as_written = !model->linearized && !state->is_work;
    Node rate = is_as_written ? state->rate : equations->rates.nodes[i];
    summary->rates[i] = as_written(model, rate);
  }
  for (size_t i = 0; i < summary->output_count; i++) summary->outputs[i] = as_written(model, equations->outputs[i]);
  return summary;
}
