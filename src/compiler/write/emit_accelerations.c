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
    for (size_t j = 0; j <= i; j++)
      if (equations->block[j] == equations->block[i]) append_nodes(&targets, &equations->mass[i * n + j], 1);
  }
  for (size_t i = 0; i < equations->pivot_count; i++) {
    const struct Pivot *pivot = &equations->pivots[i];
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

/* The members of a block; returns their number. */
static size_t block_members(const struct Equations *equations, size_t block, size_t *members) {
  size_t count = 0;
  for (size_t i = 0; i < equations->count; i++)
    if (equations->block[i] == block) members[count++] = i;
  return count;
}

static void emit_array(const struct Emitter *emitter, const char *name, size_t block, const Node *nodes, size_t count) {
  fprintf(emitter->file, "  double %s%zu[] = {", name, block);
  for (size_t i = 0; i < count; i++) {
    if (i > 0) fputs(", ", emitter->file);
    statements_operand(emitter->statements, nodes[i]);
  }
  fputs("};\n", emitter->file);
}

/* Multiplications, divisions and additions of factoring and solving a block of this size. */
static size_t factor_operations(size_t n) {
  return n * (n * n - 1) / 3 + n * (n - 1) + 2 * n * (n - 1) + n;
}

/* Factors a large block and solves it for its accelerations, written to target. */
static void emit_block_solution(struct Emitter *emitter, size_t block, const char *target) {
  const struct Equations *equations = emitter->equations;
  size_t n = emitter->n, *members = allocate(n, sizeof *members);
  size_t count = block_members(equations, block, members);
  struct NodeList mass = {0}, right = {0};
  for (size_t i = 0; i < count; i++) {
    append_nodes(&right, &equations->right_side[members[i]], 1);
    for (size_t j = 0; j <= i; j++) append_nodes(&mass, &equations->mass[members[i] * n + members[j]], 1);
  }
  emit_array(emitter, "mass", block, mass.nodes, mass.count);
  emit_array(emitter, "x", block, right.nodes, right.count);
  fprintf(emitter->file, "  static const int coordinate%zu[] = {0", block);
  for (size_t i = 0; i < count; i++) fprintf(emitter->file, ", %zu", members[i] + 1);
  fprintf(emitter->file, "};\n  const size_t singular%zu = ldlt_factor(%zu, mass%zu);\n", block, count, block);
  fprintf(emitter->file, "  if (singular%zu != 0) return coordinate%zu[singular%zu];\n", block, block, block);
  fprintf(emitter->file, "  ldlt_solve(%zu, mass%zu, x%zu);\n", count, block, block);
  for (size_t i = 0; i < count; i++) fprintf(emitter->file, "  %s[%zu] = x%zu[%zu];\n", target, members[i], block, i);
  emitter->statements->operation_count += factor_operations(count);
  free(mass.nodes);
  free(right.nodes);
  free(members);
}

void emit_accelerations(struct Emitter *emitter, const char *target) {
  const struct Equations *equations = emitter->equations;
  struct NodeList targets = acceleration_targets(emitter);
  statements_emit(emitter->statements, targets.nodes, targets.count);
  free(targets.nodes);
  for (size_t i = 0; i < equations->pivot_count; i++)
    if (!pivot_is_prepared(emitter->graph, &equations->pivots[i])) emit_pivot_check(emitter, &equations->pivots[i]);
  for (size_t i = 0; i < emitter->n; i++) {
    if (is_looped(equations, i)) continue;
    fprintf(emitter->file, "  %s[%zu] = ", target, i);
    statements_operand(emitter->statements, equations->acceleration[i]);
    fputs(";\n", emitter->file);
  }
  for (size_t block = 0; block < equations->block_count; block++)
    if (block_is_looped(equations, block)) emit_block_solution(emitter, block, target);
}

void emit_along_blocks(struct Emitter *emitter, const Node *nodes, size_t stride, const char *target,
                       const size_t *place, size_t number) {
  const struct Equations *equations = emitter->equations;
  size_t *members = allocate(emitter->n, sizeof *members);
  for (size_t block = 0; block < equations->block_count; block++) {
    if (!block_is_looped(equations, block)) continue;
    size_t count = block_members(equations, block, members);
    if (place != NULL && place[members[0]] == NOWHERE) continue;
    char *name = format_text("y%zu_", number);
    struct NodeList right = {0};
    for (size_t i = 0; i < count; i++) append_nodes(&right, &nodes[members[i] * stride], 1);
    emit_array(emitter, name, block, right.nodes, right.count);
    fprintf(emitter->file, "  ldlt_solve(%zu, mass%zu, %s%zu);\n", count, block, name, block);
    for (size_t i = 0; i < count; i++)
      fprintf(emitter->file, "  %s[%zu] = %s%zu[%zu];\n", target, place != NULL ? place[members[i]] : members[i], name,
              block, i);
    free(right.nodes);
    free(name);
  }
  free(members);
}
