/*
 * Accelerations a and constraint forces F from K (a; F) = b with K = (M J^T; J 0), block by block; the blocks are the
 * connected components of the rows that K couples. Small blocks and kinematic trees are solved symbolically
 * (mechanics/mass_matrix/) and appear as expressions. Each other block is factored at run time, K = L D L^T without
 * pivoting (ldlt.h, saddle.h). The sparse pattern is that of a minimum-degree elimination in which each constraint
 * follows its coordinates. A factorization costs the sum of the squares of the column lengths of L, a solution
 * twice the elements of L. A. George, J. W. H. Liu: Computer Solution of Large Sparse Positive Definite Systems,
 * 1981.
 */
#include "program/expressions/accelerations.h"

#include "base/memory.h"
#include "nonsymmetric.h"
#include "saddle.h"

static size_t factor_elements(const struct InertiaBlock *block) {
  return block->start[block->count];
}

/* Finds the places of the elements of K: all of them without constraints, else those that are not always 0. */
static void find_places(struct LoopedBlock *looped) {
  const struct InertiaBlock *block = looped->block;
  size_t elements = factor_elements(block);
  looped->places = allocate(elements, sizeof *looped->places);
  for (size_t k = 0; k < elements; k++)
    if (block->constraint_count == 0 || block->mass[k] != ZERO) looped->places[looped->place_count++] = k;
  looped->given = looped->first_mass + (block->constraint_count > 0 ? elements : 0);
}

/* Sets column[]: the columns, and with constraints the pattern of K. */
static void find_columns(struct LoopedBlock *looped) {
  const struct InertiaBlock *block = looped->block;
  size_t elements = factor_elements(block), n = block->count, *next;
  looped->columns = allocate(elements + n + 1 + looped->place_count, sizeof *looped->columns);
  next = looped->columns;
  for (size_t k = 0; k < elements; k++) *next++ = block->column[k];
  looped->column_count = elements;
  if (block->constraint_count == 0) return;
  for (size_t i = 0, k = 0; i <= n; i++) {
    while (k < looped->place_count && looped->places[k] < block->start[i]) k++;
    *next++ = k;
  }
  for (size_t k = 0; k < looped->place_count; k++) *next++ = block->column[looped->places[k]];
  looped->column_count += n + 1 + looped->place_count;
}

static size_t saddle_mass(const struct LoopedBlock *looped) {
  const struct InertiaBlock *block = looped->block;
  return SADDLE_MASS(factor_elements(block), looped->place_count, block->count, block->constraint_count);
}

static size_t mass_count_of(const struct LoopedBlock *looped) {
  const struct InertiaBlock *block = looped->block;
  if (block->constraint_count == 0) return factor_elements(block);
  return saddle_mass(looped) + (block->force_count > 0 ? NONSYMMETRIC_MASS(block->count, block->force_count) : 0);
}

static struct LoopedBlock looped_block(const struct InertiaBlock *block, size_t first_mass, size_t first_right_side) {
  struct LoopedBlock looped = {.block = block, .first_mass = first_mass, .first_right_side = first_right_side};
  find_places(&looped);
  find_columns(&looped);
  looped.mass_count = mass_count_of(&looped);
  return looped;
}

struct LoopedBlocks looped_blocks_of(const struct Equations *equations) {
  struct LoopedBlocks blocks = {0};
  if (equations->explicit_form) return blocks;
  const struct Inertia *inertia = equations->inertia;
  blocks.items = allocate(inertia->block_count, sizeof *blocks.items);
  for (size_t i = 0; i < inertia->block_count; i++) {
    const struct InertiaBlock *block = &inertia->blocks[i];
    if (block->is_unrolled) continue;
    bool is_saddle = block->constraint_count > 0;
    struct LoopedBlock looped = looped_block(block, blocks.mass_count, blocks.right_side_count);
    blocks.items[blocks.count++] = looped;
    blocks.mass_count += looped.mass_count;
    blocks.right_side_count += is_saddle ? SADDLE_RIGHT_SIDE(block->count) : block->count;
  }
  return blocks;
}

bool pivot_is_parameter_constants(const struct Graph *graph, const struct Pivot *pivot) {
  return graph_is_constant_in_time(graph, pivot->value) && graph_is_constant_in_time(graph, pivot->scale);
}

void append_elements(struct NodeList *targets, const struct InertiaBlock *block) {
  append_nodes(targets, block->mass, block->start[block->count]);
  append_nodes(targets, block->nonsymmetric, block->force_count * block->count);
}

struct NodeList accelerations_targets(const struct Graph *graph, const struct Equations *equations, bool with_forces) {
  struct NodeList targets = {0};
  size_t rows = equations->explicit_form ? equations->count : row_count(equations);
  for (size_t i = 0; i < rows; i++)
    if (i < equations->count || with_forces || is_looped(equations, i))
      append_node(&targets, is_looped(equations, i) ? equations->right_side[i] : equations->acceleration[i]);
  const struct Inertia *inertia = equations->inertia;
  for (size_t i = 0; !equations->explicit_form && i < inertia->block_count; i++) {
    const struct InertiaBlock *block = &inertia->blocks[i];
    if (!block->is_unrolled) append_elements(&targets, block);
  }
  for (size_t i = 0; i < inertia->pivot_count; i++) {
    const struct Pivot *pivot = &inertia->pivots[i];
    if (pivot_is_parameter_constants(graph, pivot)) continue;
    append_nodes(&targets, (const Node[]){pivot->value, pivot->diagonal, pivot->scale}, 3);
  }
  return targets;
}

void append_pivot_check(struct CodeGenerator *generator, const struct Pivot *pivot) {
  Slot number = (Slot)pivot->coordinate + 1, value = generator_slot(generator, pivot->value);
  Slot diagonal = generator_slot(generator, pivot->diagonal), scale = generator_slot(generator, pivot->scale);
  if (value != diagonal) ir_append(generator->ir, CHECK_PIVOT, number, value, diagonal, 0);
  if (diagonal != scale) ir_append(generator->ir, CHECK_DIAGONAL, number, diagonal, scale, 0);
  if (value == diagonal && diagonal == scale) ir_append(generator->ir, CHECK_POSITIVE, number, value, 0, 0);
}

void append_solution(struct CodeGenerator *generator, const struct LoopedBlocks *blocks, size_t number,
                     const Node *right_side) {
  const struct LoopedBlock *looped = &blocks->items[number];
  for (size_t i = 0; i < looped->block->count; i++)
    generator_copy(generator, slot_at(SPACE_RIGHT_SIDE, looped->first_right_side + i),
                   right_side[looped->block->coordinates[i]]);
  ir_append(generator->ir, SOLVE, (Slot)number, 0, 0, 0);
}

size_t block_operations(const struct InertiaBlock *block) {
  size_t elements = block->start[block->count], operations = block->count + 4 * (elements - block->count);
  size_t *below = allocate(block->count, sizeof *below); /* the elements of each column of L, diagonal included */
  for (size_t i = 0; i < elements; i++) below[block->column[i]]++;
  for (size_t j = 0; j < block->count; j++) operations += (below[j] - 1) * below[j] + 2 * (below[j] - 1);
  return operations;
}

Slot slot_of_diagonal(const struct LoopedBlock *looped, size_t row) {
  size_t k = 0;
  while (looped->places[k] + 1 != looped->block->start[row + 1]) k++;
  return slot_at(SPACE_MASS, looped->given + k);
}

size_t first_nonsymmetric(const struct LoopedBlock *looped) {
  return looped->first_mass + saddle_mass(looped);
}

void append_masses(struct CodeGenerator *generator, const struct LoopedBlock *looped) {
  const struct InertiaBlock *block = looped->block;
  for (size_t i = 0; i < looped->place_count; i++)
    generator_copy(generator, slot_at(SPACE_MASS, looped->given + i), block->mass[looped->places[i]]);
  for (size_t i = 0; i < block->force_count * block->count; i++)
    generator_copy(generator, slot_at(SPACE_MASS, first_nonsymmetric(looped) + i), block->nonsymmetric[i]);
}

void append_factor(struct CodeGenerator *generator, const struct LoopedBlocks *blocks, size_t number) {
  ir_append(generator->ir, FACTOR, (Slot)number, 0, 0, 0);
  generator->ir->spaces |= 1u << SPACE_MASS; /* of the factors; K may have no elements */
  generator->ir->operation_count += block_operations(blocks->items[number].block);
}

void append_factors(struct CodeGenerator *generator, const struct LoopedBlocks *blocks) {
  for (size_t b = 0; b < blocks->count; b++) {
    const struct InertiaBlock *block = blocks->items[b].block;
    struct NodeList elements = {0};
    append_elements(&elements, block);
    generator_compute(generator, elements.nodes, elements.count, false);
    append_masses(generator, &blocks->items[b]);
    append_factor(generator, blocks, b);
  }
}

/* True if undetermined constraint forces of the block are to be those of least norm. */
static bool has_least_forces(const struct InertiaBlock *block) {
  return block->constraint_count > 0 && block->force_count == 0;
}

/* Factors a block, solves it, and copies the solution to SPACE_ACCELERATION. */
static void append_block(struct CodeGenerator *generator, const struct Equations *equations,
                         const struct LoopedBlocks *blocks, size_t number, bool with_forces) {
  const struct LoopedBlock *looped = &blocks->items[number];
  const struct InertiaBlock *block = looped->block;
  append_masses(generator, looped);
  append_factor(generator, blocks, number);
  append_solution(generator, blocks, number, equations->right_side);
  if (with_forces && has_least_forces(block)) ir_append(generator->ir, LEAST_FORCES, (Slot)number, 0, 0, 0);
  for (size_t i = 0; i < block->count; i++)
    if (with_forces || block->coordinates[i] < equations->count)
      ir_copy(generator->ir, slot_at(SPACE_ACCELERATION, block->coordinates[i]),
              slot_at(SPACE_RIGHT_SIDE, looped->first_right_side + i));
}

void define_solutions(struct CodeGenerator *generator, const struct LoopedBlocks *blocks, const Node *symbol) {
  for (size_t b = 0; b < blocks->count; b++) {
    const struct LoopedBlock *looped = &blocks->items[b];
    for (size_t i = 0; i < looped->block->count; i++)
      generator_define(generator, symbol[looped->block->coordinates[i]],
                       slot_at(SPACE_RIGHT_SIDE, looped->first_right_side + i));
  }
}

void define_unknowns(struct CodeGenerator *generator, const struct Equations *equations,
                     const struct LoopedBlocks *blocks, const Node *symbol) {
  if (!rates_use_unknowns(generator->graph, equations)) return;
  for (size_t b = 0; b < blocks->count; b++)
    if (has_least_forces(blocks->items[b].block)) ir_append(generator->ir, LEAST_FORCES, (Slot)b, 0, 0, 0);
  define_solutions(generator, blocks, symbol);
}

void append_accelerations(struct CodeGenerator *generator, const struct Equations *equations,
                          const struct LoopedBlocks *blocks, bool with_forces) {
  const struct Inertia *inertia = equations->inertia;
  struct NodeList targets = accelerations_targets(generator->graph, equations, with_forces);
  generator_compute(generator, targets.nodes, targets.count, false);
  for (size_t i = 0; i < inertia->pivot_count; i++)
    if (!pivot_is_parameter_constants(generator->graph, &inertia->pivots[i]))
      append_pivot_check(generator, &inertia->pivots[i]);
  for (size_t i = 0; i < (with_forces ? row_count(equations) : equations->count); i++)
    if (!is_looped(equations, i)) generator_copy(generator, slot_at(SPACE_ACCELERATION, i), equations->acceleration[i]);
  for (size_t block = 0; block < blocks->count; block++) append_block(generator, equations, blocks, block, with_forces);
}
