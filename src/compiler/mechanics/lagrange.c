#include "mechanics/lagrange.h"

#include "algebra/differentiate.h"
#include "algebra/polynomials/shared_products.h"
#include "algebra/polynomials/shorten.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "mechanics/energies.h"
#include "mechanics/inertial_forces.h"
#include "mechanics/mass_matrix/inertia_derivation.h"
#include "mechanics/reactions.h"
#include "mechanics/switching.h"
#include "model/time_derivative.h"

/* Returns Q_i - dD/dv_i, with the dissipation function D. */
static Node *generalized_forces(const struct Model *model) {
  struct Graph *graph = model->graph;
  size_t n = model->coordinates.count;
  Node *force = allocate(n, sizeof *force);
  gradient_of(graph, model->energies.dissipation.node, VELOCITY, n, force);
  for (size_t i = 0; i < n; i++) force[i] = subtract(graph, model->forces.along[i].node, force[i]);
  return force;
}

/* Copies the elements of a block from an array over all rows; if back, copies them to that array. */
static void move_block(const struct InertiaBlock *block, Node *all, Node *of_block, bool back) {
  for (size_t i = 0; i < block->count; i++) {
    if (back) all[block->coordinates[i]] = of_block[i];
    else of_block[i] = all[block->coordinates[i]];
  }
}

static bool is_prescribed(const struct Model *model, size_t row) {
  return row < model->coordinates.count && model->prescribed.motions[row].is_prescribed;
}

/*
 * Shortens the inertial forces, block by block. Multiplied out, those in curvilinear coordinates lose terms that cancel
 * each other, but others grow. left: inertial forces of the coordinates, and ZERO for constraints; left[0] at zero
 * accelerations, left[1] with their symbols. Each is replaced only by a shorter form. Forces and potentials stay as
 * written: k*(r - l0) has smaller rounding errors than k*r - k*l0.
 */
static void shorten_inertial_forces(const struct Model *model, const struct Inertia *inertia, Node *left[2]) {
  struct Graph *graph = model->graph;
  size_t count = model->coordinates.count;
  size_t n = inertia->count;
  Node *rows = allocate(n, sizeof *rows), *other = allocate(n, sizeof *other), *part = allocate(n, sizeof *part),
       *whole = allocate(n, sizeof *whole);
  for (size_t b = 0; b < inertia->block_count; b++) {
    move_block(&inertia->blocks[b], left[0], part, false);
    shorten(graph, inertia->blocks[b].count, part);
    move_block(&inertia->blocks[b], left[0], part, true);
  }
  for (size_t i = 0; i < n; i++) other[i] = left[0][i];
  for (size_t i = 0; i < count; i++) rows[i] = model->unknowns.accelerations[i];
  inertia_add_product(graph, inertia, rows, other);
  for (size_t i = count; i < n; i++) other[i] = ZERO;
  for (size_t b = 0; b < inertia->block_count; b++) {
    /* A prescribed coordinate has the M of v' = acceleration, 1; that of a tree is not formed. */
    if (is_prescribed(model, inertia->blocks[b].coordinates[0]) || inertia->blocks[b].tree != NULL) continue;
    move_block(&inertia->blocks[b], left[1], whole, false);
    move_block(&inertia->blocks[b], other, part, false);
    take_shorter(graph, inertia->blocks[b].count, whole, part);
    move_block(&inertia->blocks[b], left[1], whole, true);
  }
}

/* Replaces the equation of a prescribed coordinate by v' = acceleration; its residual becomes the driving force. */
static void prescribe_motion(const struct Model *model, struct Equations *equations, size_t i) {
  struct Graph *graph = model->graph;
  const struct PrescribedMotion *prescribed_motion = &model->prescribed.motions[i];
  shorten(graph, 1, &equations->residual[i]);
  equations->reactions[prescribed_motion->reaction] = equations->residual[i];
  equations->right_side[i] = prescribed_motion->acceleration;
  equations->residual[i] = subtract(graph, model->unknowns.accelerations[i], prescribed_motion->acceleration);
}

/* Removes the terms with constraint forces from a right side: the matrix K contains them. */
static Node without_forces(const struct Model *model, Node node) {
  struct Graph *graph = model->graph;
  if (model->switches.friction_count == 0 || !graph_depends_on(graph, node, ACCELERATION)) return node;
  Node *symbols = own_symbols(graph);
  for (size_t j = 0; j < model->constraints.count; j++) symbols[graph->vertices[model->unknowns.forces[j]].left] = ZERO;
  substitute(graph, &node, 1, symbols, &node);
  return node;
}

/* Derives right_side, which is Q less the bias forces, and residual, M a - right_side. */
static void derive_motion(const struct Model *model, struct Equations *equations, const Node *force) {
  struct Graph *graph = model->graph;
  size_t n = equations->count;
  Node lagrangian = subtract(graph, model->energies.explicit_kinetic.node, model->energies.potential.node);
  Node *momentum = allocate(n, sizeof *momentum), *gradient = allocate(n, sizeof *gradient);
  Node *rate = allocate(n, sizeof *rate);
  Node *left[2] = {allocate(row_count(equations), sizeof(Node)), allocate(row_count(equations), sizeof(Node))};
  gradient_of(graph, lagrangian, VELOCITY, n, momentum);
  gradient_of(graph, lagrangian, COORDINATE, n, gradient);
  for (int with_accelerations = 0; with_accelerations <= 1; with_accelerations++) {
    Node *seeds = time_seeds(model, with_accelerations == 1);
    Node *inertial = inertial_forces(model, seeds, COORDINATE, n);
    derivative_along(graph, momentum, n, seeds, rate);
    for (size_t i = 0; i < n; i++) left[with_accelerations][i] = add(graph, inertial[i], rate[i]);
  }
  shorten_inertial_forces(model, equations->inertia, left);
  for (size_t i = 0; i < n; i++) {
    Node right = add(graph, force[i], gradient[i]);
    equations->right_side[i] = without_forces(model, subtract(graph, right, left[0][i]));
    equations->residual[i] = subtract(graph, left[1][i], right);
    if (model->prescribed.motions[i].is_prescribed) prescribe_motion(model, equations, i);
  }
}

/* Adds the rows of the constraints, and J^T F to the rows of the coordinates. */
static void add_constraints(const struct Model *model, struct Equations *equations) {
  const struct Constraints *constraints = equations->constraints;
  struct Graph *graph = model->graph;
  const struct Elements *free_ones = &constraints->jacobian, *prescribed = &constraints->prescribed;
  for (size_t k = 0; k < free_ones->count; k++) {
    Node *sum = &equations->residual[free_ones->positions[k].column];
    *sum = add(graph, *sum, constraint_force_along(graph, free_ones, k, model->unknowns.forces));
  }
  for (size_t k = 0; k < prescribed->count; k++) {
    Node *sum = &equations->reactions[model->prescribed.motions[prescribed->positions[k].column].reaction];
    *sum = add(graph, *sum, constraint_force_along(graph, prescribed, k, model->unknowns.forces));
  }
  for (size_t j = 0; j < constraints->count; j++) {
    equations->residual[equations->count + j] = constraints->acceleration[j];
    equations->right_side[equations->count + j] = negate(graph, constraints->acceleration_rest[j]);
  }
}

/* Returns the unknowns of unrolled blocks as expressions, and the right sides of those solved at run time. */
static Node *solution_of(struct Graph *graph, const struct Equations *equations, const Node *right_side) {
  Node *solution = allocate(row_count(equations), sizeof *solution);
  inertia_solve(graph, equations->inertia, right_side, solution);
  for (size_t i = 0; i < row_count(equations); i++)
    if (is_looped(equations, i)) solution[i] = right_side[i];
  return solution;
}

/* Solves for the accelerations. Uses shared products of the right sides if that makes the accelerations shorter. */
static void solve_for_accelerations(const struct Model *model, struct Equations *equations) {
  struct Graph *graph = model->graph;
  size_t rows = row_count(equations);
  Node *shared = allocate(2 * rows, sizeof *shared); /* right sides, then residuals */
  for (size_t i = 0; i < rows; i++) {
    shared[i] = equations->right_side[i];
    shared[rows + i] = equations->residual[i];
  }
  share_products(graph, rows, 2 * rows, shared);
  Node *solution = solution_of(graph, equations, equations->right_side), *other = solution_of(graph, equations, shared);
  bool is_shorter = are_shorter(graph, rows, other, solution);
  for (size_t i = 0; i < rows; i++) {
    if (is_shorter) equations->right_side[i] = shared[i];
    if (is_shorter) equations->residual[i] = shared[rows + i];
    Node acceleration = is_shorter ? other[i] : solution[i];
    equations->acceleration[i] = is_looped(equations, i) ? unknown_of_row(model, i) : acceleration;
  }
}

/* Replaces the unknowns that are solved symbolically by their expressions. */
static Node with_accelerations(const struct Model *model, const struct Equations *equations, Node node) {
  struct Graph *graph = model->graph;
  if (!graph_depends_on(graph, node, ACCELERATION)) return node;
  Node *symbols = own_symbols(graph);
  for (size_t i = 0; i < row_count(equations); i++)
    symbols[graph->vertices[unknown_of_row(model, i)].left] = equations->acceleration[i];
  substitute(graph, &node, 1, symbols, &node);
  shorten(graph, 1, &node);
  return node;
}

/* Returns the power of forces, dissipation, prescribed motions, and inputs that move positions. */
static Node power_of_forces(const struct Model *model, const struct Equations *equations, const Node *force) {
  struct Graph *graph = model->graph;
  Node power = ZERO;
  for (size_t i = 0; i < equations->count; i++) {
    const struct PrescribedMotion *prescribed_motion = &model->prescribed.motions[i];
    Node whole = prescribed_motion->is_prescribed
                     ? add(graph, force[i], equations->reactions[prescribed_motion->reaction])
                     : force[i];
    power = add(graph, power, multiply(graph, whole, model->velocities.items[i].node));
  }
  power = add(graph, power, power_of_moving_points(model));
  return add(graph, power, model->forces.prescribed_power.node);
}

static void derive_energies(const struct Model *model, struct Equations *equations, const Node *force) {
  struct Graph *graph = model->graph;
  equations->kinetic = model->energies.kinetic_energy.node;
  equations->potential = stored_energy(model, model->energies.potential.node);
  equations->total = add(graph, equations->kinetic, equations->potential);
  equations->stated_power = power_of_forces(model, equations, force);
  if (work_includes_all_forces(model))
    derivative_along(graph, &equations->total, 1, time_seeds(model, true), &equations->stated_power);
  equations->power = equations->stated_power;
  if (work_of(model) != NULL) equations->power = with_accelerations(model, equations, equations->power);
}

/* Derives the rates of the states of first order. */
static void derive_rates(const struct Model *model, struct Equations *equations) {
  for (size_t i = 0; i < model->states.count; i++) {
    const struct Variable *state = &model->states.items[i];
    Node rate = state == work_of(model) ? equations->power : with_reactions(model, equations->reactions, state->rate);
    append_node(&equations->rates, with_accelerations(model, equations, rate));
  }
}

/* Returns the expression of an output. Its branches may depend on reactions, which may have branches themselves. */
static Node output_of(const struct Model *model, const Node *reactions, Node node) {
  node = with_reactions(model, reactions, without_branches(model, node));
  return without_branches(model, node);
}

static void copy_outputs(const struct Model *model, struct Equations *equations) {
  for (size_t i = 0; i < model->outputs.count; i++)
    equations->outputs[i] = output_of(model, equations->reactions, model->outputs.items[i].node);
  for (size_t i = 0; i < model->mechanism.element_variables.count; i++)
    equations->element_variables[i] = without_branches(model, model->mechanism.element_variables.items[i].node);
}

struct Equations *equations_derive(const struct Model *model, struct Diagnostics *diagnostics) {
  struct Graph *graph = model->graph;
  size_t n = model->coordinates.count;
  int errors = diagnostics->errors;
  struct Equations *equations = equations_create(model);
  Node *momentum = allocate(n, sizeof *momentum), *force = generalized_forces(model);
  Node regularization = energy_of_regularization(model),
       kinetic = add(graph, model->energies.kinetic.node, regularization);
  gradient_of(graph, subtract(graph, kinetic, model->energies.potential.node), VELOCITY, n, momentum);
  const struct Constraints *constraints = equations->constraints;
  const struct ConstraintBlock constraint_block = {constraints->count, &constraints->jacobian,
                                                   &constraints->nonsymmetric};
  equations->inertia = inertia_derive(model, momentum, regularization, &constraint_block, diagnostics);
  if (equations->inertia != NULL) {
    derive_motion(model, equations, force);
    add_constraints(model, equations);
    solve_for_accelerations(model, equations);
    derive_energies(model, equations, force);
    reactions_derive(model, equations->reactions);
    derive_rates(model, equations);
    copy_outputs(model, equations);
  }
  if (graph_limit(graph) != NULL)
    report_error(diagnostics, 0, "the equations of motion need %s; expected a smaller system", graph_limit(graph));
  return diagnostics->errors == errors ? equations : NULL;
}
