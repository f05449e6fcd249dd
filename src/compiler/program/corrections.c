/*
 * Code for the projection onto the constraints g(q) = 0. Each correction (dq; F) solves
 *
 *     M dq + J^T F = -M moved,   J dq = -g(q),
 *
 * with the symmetric indefinite matrix K = (M J^T; J 0) of the equations of motion, where moved is the sum of the
 * corrections so far. These are Newton's steps, without the second derivatives of g, for the nearest point in the
 * metric of M: minimize moved^T M moved subject to g = 0. The velocities need one step, as the constraints are linear
 * in them. The runtime (methods/projection.c) iterates and decides when to stop. A correction costs one factorization
 * of each constrained block: O(n^3) if it is full, O(n) for a tree, whose solution is symbolic. E. Hairer, C. Lubich,
 * G. Wanner: Geometric Numerical Integration, section IV.4.
 */
#include "program/builders.h"

/*
 * Factor on the diagonal elements of M for fixed coordinates. It is large enough that only the other coordinates
 * move at the start, and small enough that the factors of K keep their digits.
 */
static const double weight_of_fixed = 1e12;

static void weigh_fixed(const struct Program *program, struct CodeGenerator *generator,
                        const struct LoopedBlock *looped) {
  const struct Model *model = program->model;
  const struct InertiaBlock *block = looped->block;
  Slot weight = slot_at(SPACE_NUMBER, graph_constant(model->graph, weight_of_fixed));
  for (size_t i = 0; i < block->count; i++) {
    size_t row = block->coordinates[i];
    if (row >= model->coordinates.count || !model->coordinates.items[row].is_fixed) continue;
    Slot mass = slot_of_diagonal(looped, i);
    ir_append(generator->ir, PRODUCT, mass, mass, weight, 0);
  }
}

/* Sets the nonsymmetric columns of K to 0: forces that depend on others take no part in corrections and impulses. */
static void leave_nonsymmetric_out(struct CodeGenerator *generator, const struct LoopedBlock *looped) {
  const struct InertiaBlock *block = looped->block;
  for (size_t i = 0; i < block->force_count * block->count; i++)
    generator_copy(generator, slot_at(SPACE_MASS, first_nonsymmetric(looped) + i), ZERO);
}

/* Factors the block and solves for side, with an element for each row of K. starting: fixed coordinates stay. */
static void append_solved(const struct Program *program, struct CodeGenerator *generator, size_t number,
                          const Node *right_side, bool starting) {
  const struct LoopedBlock *looped = &program->blocks.items[number];
  append_masses(generator, looped);
  leave_nonsymmetric_out(generator, looped);
  if (starting) weigh_fixed(program, generator, looped);
  append_factor(generator, &program->blocks, number);
  append_solution(generator, &program->blocks, number, right_side);
}

/*
 * Appends the correction of one block. Solves for side, then copies the changes of its coordinates and the last
 * pivots of its constraints to the targets.
 */
static void append_block(const struct Program *program, struct CodeGenerator *generator, size_t number,
                         const Node *right_side, bool starting) {
  const struct LoopedBlock *looped = &program->blocks.items[number];
  const struct InertiaBlock *block = looped->block;
  size_t n = program->equations->count, constraints = program->equations->constraints->count;
  append_solved(program, generator, number, right_side, starting);
  for (size_t i = 0; i < block->count; i++) {
    size_t row = block->coordinates[i];
    Slot pivot = slot_at(SPACE_MASS, looped->first_mass + block->start[i + 1] - 1);
    if (row < n) ir_copy(generator->ir, target_slot(row), slot_at(SPACE_RIGHT_SIDE, looped->first_right_side + i));
    else ir_copy(generator->ir, target_slot(row + constraints), pivot);
  }
}

/* Computes the elements and right sides of all constrained blocks, and the further nodes. */
static void compute_blocks(const struct Program *program, struct CodeGenerator *generator, const Node *right_side,
                           const Node *further, size_t further_count) {
  struct NodeList targets = {0};
  append_nodes(&targets, further, further_count);
  for (size_t b = 0; b < program->blocks.count; b++) {
    const struct InertiaBlock *block = program->blocks.items[b].block;
    if (block->constraint_count == 0) continue;
    append_elements(&targets, block);
    for (size_t i = 0; i < block->count; i++) append_node(&targets, right_side[block->coordinates[i]]);
  }
  generator_compute(generator, targets.nodes, targets.count, false);
}

/* True if the row belongs to a kinematic tree that has constraints. */
static bool is_in_tree(const struct Program *program, size_t row) {
  const struct InertiaBlock *block = inertia_block_of(program->equations->inertia, row);
  return block->tree != NULL && block->constraint_count > 0;
}

/* Copies the changes and pivots of kinematic trees, which are expressions, to the targets. */
static void append_trees(const struct Program *program, struct CodeGenerator *generator, const Node *change) {
  size_t n = program->equations->count, constraints = program->equations->constraints->count;
  for (size_t i = 0; i < n; i++) generator_copy(generator, target_slot(i), is_in_tree(program, i) ? change[i] : ZERO);
  for (size_t j = 0; j < constraints; j++)
    if (is_in_tree(program, n + j))
      generator_copy(generator, target_slot(n + constraints + j), program->expressions->corrections.pivot[j]);
}

/* Returns the nodes of a correction outside blocks that are factored: slopes, pivots, right sides in trees. */
static struct NodeList nodes_of_correction(const struct Program *program, const Node *right_side) {
  const struct Corrections *corrections = &program->expressions->corrections;
  size_t n = program->equations->count, constraints = program->equations->constraints->count;
  struct NodeList nodes = {0};
  append_nodes(&nodes, corrections->slope, constraints);
  append_nodes(&nodes, corrections->pivot, constraints);
  for (size_t i = 0; i < n + constraints; i++)
    if (is_in_tree(program, i)) append_node(&nodes, right_side[i]);
  return nodes;
}

/* Builds a correction for side, which has an element for each row of K. starting: fixed coordinates stay. */
static struct IrFunction *build_correction(const struct Program *program, struct CodeGenerator *generator,
                                           const Node *right_side, bool starting) {
  struct IrFunction *ir = generator_begin(generator);
  const struct Equations *equations = program->equations;
  const Node *slope = program->expressions->corrections.slope;
  size_t n = equations->count, constraints = equations->constraints->count;
  const struct NodeList further = nodes_of_correction(program, right_side);
  compute_blocks(program, generator, right_side, further.nodes, further.count);
  append_trees(program, generator, right_side);
  for (size_t j = 0; j < constraints; j++) {
    generator_copy(generator, target_slot(n + j), right_side[n + j]);
    generator_copy(generator, target_slot(n + 2 * constraints + j), slope[j]);
  }
  for (size_t b = 0; b < program->blocks.count; b++)
    if (program->blocks.items[b].block->constraint_count > 0) append_block(program, generator, b, right_side, starting);
  return ir;
}

struct IrFunction *build_correct_positions(const struct Program *program, struct CodeGenerator *generator) {
  return build_correction(program, generator, program->expressions->corrections.position, false);
}

struct IrFunction *build_correct_velocities(const struct Program *program, struct CodeGenerator *generator) {
  return build_correction(program, generator, program->expressions->corrections.velocity, false);
}

struct IrFunction *build_start_positions(const struct Program *program, struct CodeGenerator *generator) {
  return build_correction(program, generator, program->expressions->corrections.position, true);
}

struct IrFunction *build_start_velocities(const struct Program *program, struct CodeGenerator *generator) {
  return build_correction(program, generator, program->expressions->corrections.velocity, true);
}

struct IrFunction *build_responses(const struct Program *program, struct CodeGenerator *generator) {
  struct IrFunction *ir = generator_begin(generator);
  const Node *impulse = program->expressions->corrections.impulse;
  size_t n = program->equations->count;
  compute_blocks(program, generator, impulse, impulse, n);
  for (size_t i = 0; i < n; i++) generator_copy(generator, target_slot(i), ZERO);
  for (size_t i = 0; i < n; i++) generator_copy(generator, target_slot(n + i), impulse[i]);
  for (size_t b = 0; b < program->blocks.count; b++) {
    const struct LoopedBlock *looped = &program->blocks.items[b];
    const struct InertiaBlock *block = looped->block;
    if (block->constraint_count == 0) continue;
    append_solved(program, generator, b, impulse, false);
    for (size_t i = 0; i < block->count; i++)
      if (block->coordinates[i] < n)
        ir_copy(generator->ir, target_slot(block->coordinates[i]),
                slot_at(SPACE_RIGHT_SIDE, looped->first_right_side + i));
  }
  return ir;
}
