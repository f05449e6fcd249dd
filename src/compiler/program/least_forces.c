/*
 * Derivatives of the least-norm constraint forces. Where constraints are redundant, J^T F is determined but F is not;
 * the solution of least norm lies in the range of J, F = J w. Along a direction
 *
 *     dF = dJ w + J dw,
 *
 * so that dF - dJ w is again in the range of J. Hence, from any dF that solves the differentiated equations, subtract
 * dJ w, take the least-norm representative of the rest, and add dJ w. w solves K (w; y) = (0; F) with the factors of K
 * that are there. Costs one solution and one least-norm projection for each block, and the elements of dJ. The rank of
 * J is constant nearby (G. Golub, V. Pereyra: The differentiation of pseudo-inverses and nonlinear least squares
 * problems whose variables separate, 1973).
 */
#include "program/builders.h"

#include "base/memory.h"

/* A constraint, with the slots of its numbers in the block that is factored at run time. */
struct ForceRow {
  Slot right_side, target, force;
  Slot change;     /* its element of dJ w, if has_change */
  bool has_change; /* it has a nonzero element of dJ w */
  bool is_looped;  /* in a block that is factored at run time; no other constraint is redundant */
};

static struct ForceRow *rows_create(const struct Program *program) {
  size_t n = program->equations->count;
  struct ForceRow *rows = allocate(program->equations->constraints->count, sizeof *rows);
  for (size_t b = 0; b < program->blocks.count; b++) {
    const struct LoopedBlock *looped = &program->blocks.items[b];
    for (size_t i = 0; i < looped->block->count; i++) {
      size_t row = looped->block->coordinates[i];
      if (row >= n)
        rows[row - n] = (struct ForceRow){.right_side = slot_at(SPACE_RIGHT_SIDE, looped->first_right_side + i),
                                          .target = target_slot(row),
                                          .is_looped = true,
                                          .force = slot_at(SPACE_ACCELERATION, row)};
    }
  }
  return rows;
}

/* Solves K (w; y) = (0; F) for the block, whose right side then holds w. */
static void append_origins(const struct Program *program, struct CodeGenerator *generator, size_t number,
                           const struct ForceRow *rows) {
  const struct LoopedBlock *looped = &program->blocks.items[number];
  size_t n = program->equations->count;
  for (size_t i = 0; i < looped->block->count; i++) {
    size_t row = looped->block->coordinates[i];
    Slot right_side = slot_at(SPACE_RIGHT_SIDE, looped->first_right_side + i);
    if (row < n) generator_copy(generator, right_side, ZERO);
    else ir_copy(generator->ir, right_side, rows[row - n].force);
  }
  ir_append(generator->ir, SOLVE, (Slot)number, 0, 0, 0);
}

static Slot right_side_of(const struct Program *program, size_t coordinate) {
  const struct Inertia *inertia = program->equations->inertia;
  for (size_t b = 0; b < program->blocks.count; b++)
    if (program->blocks.items[b].block == inertia_block_of(inertia, coordinate))
      return slot_at(SPACE_RIGHT_SIDE, program->blocks.items[b].first_right_side + inertia->index_in_block[coordinate]);
  return 0;
}

/* Computes dJ w into local variables. */
static void append_changes(const struct Program *program, struct CodeGenerator *generator, struct ForceRow *rows) {
  const struct Elements *jacobian = &program->equations->constraints->jacobian;
  const Node *along = program->expressions->constraints_along;
  generator_compute(generator, along, jacobian->count, false);
  for (size_t k = 0; k < jacobian->count; k++) {
    if (along[k] == ZERO) continue;
    struct ForceRow *row = &rows[jacobian->positions[k].row];
    if (!row->is_looped) continue;
    Slot term = ir_new_local(generator->ir), right_side = right_side_of(program, jacobian->positions[k].column);
    ir_append(generator->ir, PRODUCT, term, generator_slot(generator, along[k]), right_side, 0);
    Slot sum = row->has_change ? ir_new_local(generator->ir) : term;
    if (row->has_change) ir_append(generator->ir, SUM, sum, row->change, term, 0);
    row->change = sum;
    row->has_change = true;
  }
}

static bool any_changes(const struct Program *program) {
  bool any = false;
  for (size_t k = 0; k < program->equations->constraints->jacobian.count; k++)
    any |= program->expressions->constraints_along[k] != ZERO;
  return any;
}

void append_least_forces_along(const struct Program *program, struct CodeGenerator *generator) {
  struct ForceRow *rows = rows_create(program);
  size_t count = program->equations->constraints->count;
  const struct LoopedBlocks *blocks = &program->blocks;
  bool has_change = any_changes(program);
  for (size_t b = 0; b < blocks->count; b++)
    if (has_change && blocks->items[b].block->constraint_count > 0) append_origins(program, generator, b, rows);
  append_changes(program, generator, rows);
  for (size_t j = 0; j < count; j++) {
    if (!rows[j].is_looped) continue;
    if (rows[j].has_change) ir_append(generator->ir, DIFFERENCE, rows[j].right_side, rows[j].target, rows[j].change, 0);
    else ir_copy(generator->ir, rows[j].right_side, rows[j].target);
  }
  for (size_t b = 0; b < blocks->count; b++)
    if (blocks->items[b].block->constraint_count > 0) ir_append(generator->ir, LEAST_FORCES, (Slot)b, 0, 0, 0);
  for (size_t j = 0; j < count; j++) {
    if (!rows[j].is_looped) continue;
    if (rows[j].has_change) ir_append(generator->ir, SUM, rows[j].target, rows[j].right_side, rows[j].change, 0);
    else ir_copy(generator->ir, rows[j].target, rows[j].right_side);
  }
}
