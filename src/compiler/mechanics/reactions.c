#include "mechanics/reactions.h"

#include "algebra/differentiate.h"
#include "algebra/polynomials/shorten.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "mechanics/inertial_forces.h"
#include "model/time_derivative.h"
#include "mechanics/virtual_work.h"

/* Returns the generalized forces of point forces and torques along symbols of a kind, each followed by its rate. */
static Node *point_forces(const struct Model *model, enum SymbolKind kind, size_t count) {
  const struct Forces *forces = &model->forces;
  struct Graph *graph = model->graph;
  struct VirtualWork work = {0}, work_of_torques = {0};
  for (size_t i = 0; i < forces->point_count; i++)
    if (graph_depends_on(graph, forces->at_points[i].position, kind))
      virtual_work_add(&work, forces->at_points[i].position, forces->at_points[i].force);
  for (size_t i = 0; i < forces->torque_count; i++)
    for (int axis = 0; axis < 3; axis++) {
      const struct Torque *torque = &forces->torques[i];
      if (graph_depends_on(graph, torque->angular_velocity.along[axis], kind))
        virtual_work_add(&work_of_torques, torque->angular_velocity.along[axis], torque->torque.along[axis]);
    }
  Node *along = virtual_work_along(graph, &work, kind, count);
  virtual_work_add_along_rates(graph, &work_of_torques, kind, count, along);
  return along;
}

/* Returns R + Q_s along each symbol of the kind that is followed by its rate, as in reactions.h. */
static Node *forces_along(const struct Model *model, enum SymbolKind kind, size_t count) {
  struct Graph *graph = model->graph;
  Node lagrangian = subtract(graph, model->energies.displaced_kinetic.node, model->energies.displaced_potential.node);
  Node *seeds = time_seeds(model, true), *force = inertial_forces(model, seeds, kind, count);
  Node *slope = allocate(count, sizeof *slope), *rate = allocate(count, sizeof *rate);
  gradient_of(graph, lagrangian, kind, count, slope);
  derivative_along(graph, slope, count, seeds, rate);
  for (size_t i = 0; i + 1 < count; i++) force[i] = add(graph, force[i], subtract(graph, rate[i + 1], slope[i]));
  return force;
}

void reactions_derive(const struct Model *model, Node *reactions) {
  struct Graph *graph = model->graph;
  size_t count = model->displacements.count;
  if (count == 0) return;
  Node *force = forces_along(model, DISPLACEMENT, 2 * count), *undisplaced = undisplaced_symbols(graph);
  Node *applied = point_forces(model, DISPLACEMENT, 2 * count), *damping = allocate(2 * count, sizeof *damping);
  gradient_of(graph, model->energies.displaced_dissipation.node, DISPLACEMENT, 2 * count, damping);
  for (size_t i = 0; i < count; i++)
    reactions[i] = subtract(graph, subtract(graph, applied[2 * i], damping[2 * i + 1]), force[2 * i]);
  substitute(graph, reactions, count, undisplaced, reactions);
  for (size_t i = 0; i < count; i++) shorten(graph, 1, &reactions[i]);
}

/* Forces at a point that an input moves act on the system through this input. The input delivers R, the forces Q. */
Node power_of_moving_points(const struct Model *model) {
  struct Graph *graph = model->graph;
  size_t count = model->inputs.count;
  if (!model->prescribed.inputs_move) return ZERO;
  Node *force = forces_along(model, INPUT, count), *undisplaced = undisplaced_symbols(graph), power = ZERO;
  for (size_t i = 0; i + 1 < count; i++)
    if (!is_input_rate(model, i))
      power = add(graph, power, multiply(graph, force[i], model->prescribed.input_rates[i]));
  substitute(graph, &power, 1, undisplaced, &power);
  return power;
}

Node *undisplaced_symbols(const struct Graph *graph) {
  Node *symbols = own_symbols(graph);
  for (size_t i = 0; i < graph->symbol_count; i++)
    if (graph->symbols[i].kind == DISPLACEMENT) symbols[i] = ZERO;
  return symbols;
}

Node with_reactions(const struct Model *model, const Node *reactions, Node node) {
  struct Graph *graph = model->graph;
  if (!graph_depends_on(graph, node, REACTION)) return node;
  Node *symbols = own_symbols(graph);
  for (size_t i = 0; i < model->reactions.count; i++)
    symbols[graph->vertices[model->reactions.items[i].node].left] = reactions[i];
  substitute(graph, &node, 1, symbols, &node);
  return node;
}
