#include "write/emit_accelerations.h"

#include <stdlib.h>

#include "memory.h"

bool pivot_is_prepared(const struct Graph *graph, const struct Pivot *pivot) {
  return graph_is_constant_in_time(graph, pivot->value) && graph_is_constant_in_time(graph, pivot->scale);
}

struct NodeList acceleration_targets(const struct Emitter *emitter) {
  const struct Equations *equations = emitter->equations;
  struct NodeList targets = {0};
  size_t n = emitter->n;
  for (size_t i = 0; i < n; i++) {
    if (!is_looped(equations, i)) {
      append_nodes(&targets, &equations->acceleration[i], 1);
      continue;
    }
    append_nodes(&targets, &equations->right_side[i], 1);
    const struct InertiaBlock *block = inertia_block_of(equations->inertia, i);
    size_t row = equations->inertia->place_of[i];
    append_nodes(&targets, block->mass + block->start[row], block->start[row + 1] - block->start[row]);
  }
  for (size_t i = 0; i < equations->inertia->pivot_count; i++) {
    const struct Pivot *pivot = &equations->inertia->pivots[i];
    if (pivot_is_prepared(emitter->graph, pivot)) continue;
    append_nodes(&targets, (const Node[]){pivot->value, pivot->diagonal, pivot->scale}, 3);
  }
  return targets;
}

void emit_pivot_check(const struct Emitter *emitter, const struct Pivot *pivot) {
  const struct Statements *statements = emitter->statements;
  const struct {
    Node small, large;
    double share; /* below this share of large, small is a rounding error */
  } conditions[] = {{pivot->value, pivot->diagonal, 1e-14}, {pivot->diagonal, pivot->scale, 1e-28}};
  bool checked = false;
  fputs("  if (!(", emitter->file);
  for (int i = 0; i < 2; i++) {
    if (conditions[i].small == conditions[i].large) continue;
    if (checked) fputs(" && ", emitter->file);
    statements_operand(statements, conditions[i].small);
    fprintf(emitter->file, " > %g * ", conditions[i].share);
    statements_operand(statements, conditions[i].large);
    checked = true;
  }
  if (!checked) {
    statements_operand(statements, pivot->value);
    fputs(" > 0.0", emitter->file);
  }
  fprintf(emitter->file, ")) return %zu;\n", pivot->coordinate + 1);
}

static void emit_array(const struct Emitter *emitter, const char *name, size_t block, const Node *nodes, size_t count) {
  fprintf(emitter->file, "  double %s%zu[] = {", name, block);
  for (size_t i = 0; i < count; i++) {
    if (i > 0) fputs(", ", emitter->file);
    statements_operand(emitter->statements, nodes[i]);
  }
  fputs("};\n", emitter->file);
}

/* Multiplications, divisions and additions of factoring and solving a full block of this size. */
static size_t factor_operations(size_t n) {
  return n * (n * n - 1) / 3 + n * (n - 1) + 2 * n * (n - 1) + n;
}

static void emit_sizes(FILE *file, const char *name, size_t number, const size_t *sizes, size_t count) {
  fprintf(file, "static const size_t %s%zu[] = {%zu", name, number, sizes[0]);
  for (size_t i = 1; i < count; i++) fprintf(file, ", %zu", sizes[i]);
  fputs("};\n", file);
}

void emit_patterns(const struct Emitter *emitter) {
  const struct Inertia *inertia = emitter->equations->inertia;
  for (size_t number = 0; number < inertia->block_count; number++) {
    const struct InertiaBlock *block = &inertia->blocks[number];
    if (block->is_unrolled || block_is_full(block)) continue;
    fprintf(emitter->file, "/* Where block %zu of the mass matrix and its factors have elements (ldlt.h) */\n", number);
    emit_sizes(emitter->file, "start", number, block->start, block->count + 1);
    emit_sizes(emitter->file, "column", number, block->column, block->start[block->count]);
    fputs("\n", emitter->file);
  }
}

char *pattern_text(const struct Inertia *inertia, size_t number) {
  if (block_is_full(&inertia->blocks[number])) return copy_text("NULL, NULL");
  return format_text("start%zu, column%zu", number, number);
}

/* Factors a large block and solves it for its accelerations, written to target. */
static void emit_block_solution(struct Emitter *emitter, size_t number, const char *target) {
  const struct Equations *equations = emitter->equations;
  const struct InertiaBlock *block = &equations->inertia->blocks[number];
  size_t count = block->count;
  struct NodeList right = {0};
  char *pattern = pattern_text(equations->inertia, number);
  for (size_t i = 0; i < count; i++) append_nodes(&right, &equations->right_side[block->coordinates[i]], 1);
  emit_array(emitter, "mass", number, block->mass, block->start[count]);
  emit_array(emitter, "x", number, right.nodes, right.count);
  fprintf(emitter->file, "  static const int coordinate%zu[] = {0", number);
  for (size_t i = 0; i < count; i++) fprintf(emitter->file, ", %zu", block->coordinates[i] + 1);
  fprintf(emitter->file, "};\n  const size_t singular%zu = ldlt_factor(%zu, %s, mass%zu);\n", number, count, pattern,
          number);
  fprintf(emitter->file, "  if (singular%zu != 0) return coordinate%zu[singular%zu];\n", number, number, number);
  fprintf(emitter->file, "  ldlt_solve(%zu, %s, mass%zu, x%zu);\n", count, pattern, number, number);
  for (size_t i = 0; i < count; i++)
    fprintf(emitter->file, "  %s[%zu] = x%zu[%zu];\n", target, block->coordinates[i], number, i);
  emitter->statements->operation_count += factor_operations(count);
  free(pattern);
  free(right.nodes);
}

void emit_accelerations(struct Emitter *emitter, const char *target) {
  const struct Equations *equations = emitter->equations;
  struct NodeList targets = acceleration_targets(emitter);
  statements_emit(emitter->statements, targets.nodes, targets.count);
  free(targets.nodes);
  for (size_t i = 0; i < equations->inertia->pivot_count; i++)
    if (!pivot_is_prepared(emitter->graph, &equations->inertia->pivots[i]))
      emit_pivot_check(emitter, &equations->inertia->pivots[i]);
  for (size_t i = 0; i < emitter->n; i++) {
    if (is_looped(equations, i)) continue;
    fprintf(emitter->file, "  %s[%zu] = ", target, i);
    statements_operand(emitter->statements, equations->acceleration[i]);
    fputs(";\n", emitter->file);
  }
  for (size_t block = 0; block < equations->inertia->block_count; block++)
    if (!equations->inertia->blocks[block].is_unrolled) emit_block_solution(emitter, block, target);
}

void emit_along_blocks(struct Emitter *emitter, const Node *nodes, size_t stride, const char *target, size_t number) {
  const struct Inertia *inertia = emitter->equations->inertia;
  for (size_t b = 0; b < inertia->block_count; b++) {
    const struct InertiaBlock *block = &inertia->blocks[b];
    if (block->is_unrolled) continue;
    char *name = format_text("y%zu_", number), *pattern = pattern_text(inertia, b);
    struct NodeList right = {0};
    for (size_t i = 0; i < block->count; i++) append_nodes(&right, &nodes[block->coordinates[i] * stride], 1);
    emit_array(emitter, name, b, right.nodes, right.count);
    fprintf(emitter->file, "  ldlt_solve(%zu, %s, mass%zu, %s%zu);\n", block->count, pattern, b, name, b);
    for (size_t i = 0; i < block->count; i++)
      fprintf(emitter->file, "  %s[%zu] = %s%zu[%zu];\n", target, block->coordinates[i], name, b, i);
    free(right.nodes);
    free(pattern);
    free(name);
  }
}
