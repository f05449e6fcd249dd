#include "mechanics/mass_matrix/inertia.h"

#include "algebra/differentiate.h"
#include "algebra/polynomials/rational.h"
#include "algebra/simplify.h"
#include "base/memory.h"

/*
 * Returns the index of an element of the lower triangle in the block; start[count] if it is not in the pattern. row and
 * column are positions in the block.
 */
static size_t find(const struct InertiaBlock *block, size_t row, size_t column) {
  size_t low = block->start[row], high = block->start[row + 1];
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (block->column[middle] == column) return middle;
    if (block->column[middle] < column) low = middle + 1;
    else high = middle;
  }
  return block->start[block->count];
}

size_t inertia_find(const struct Inertia *inertia, size_t i, size_t j) {
  size_t a = inertia->index_in_block[i], b = inertia->index_in_block[j];
  return find(inertia_block_of(inertia, i), a > b ? a : b, a > b ? b : a);
}

static Node *substitute_all(struct Graph *graph, const Node *nodes, size_t count, const Node *replacements) {
  if (nodes == NULL) return NULL;
  Node *results = allocate(count, sizeof *results);
  substitute(graph, nodes, count, replacements, results);
  return results;
}

static void substitute_pivots(struct Graph *graph, const struct Inertia *from, struct Inertia *to,
                              const Node *replacements) {
  to->pivots = allocate(from->pivot_count, sizeof *to->pivots);
  for (size_t i = 0; i < from->pivot_count; i++) {
    const struct Pivot *pivot = &from->pivots[i];
    Node parts[] = {pivot->value, pivot->diagonal, pivot->scale};
    substitute(graph, parts, 3, replacements, parts);
    for (int part = 0; part < 3; part++) parts[part] = simplify_fraction(graph, parts[part]);
    to->pivots[i] = (struct Pivot){parts[0], parts[1], parts[2], pivot->coordinate};
  }
}

struct Inertia *inertia_substitute(struct Graph *graph, const struct Inertia *inertia, const Node *replacements) {
  struct Inertia *result = allocate(1, sizeof *result);
  *result = *inertia;
  result->blocks = allocate(inertia->block_count, sizeof *result->blocks);
  for (size_t b = 0; b < inertia->block_count; b++) {
    const struct InertiaBlock *from = &inertia->blocks[b];
    size_t elements = from->start[from->count];
    result->blocks[b] = (struct InertiaBlock){.count = from->count,
                                              .constraint_count = from->constraint_count,
                                              .coordinates = from->coordinates,
                                              .is_unrolled = from->is_unrolled,
                                              .start = from->start,
                                              .column = from->column,
                                              .mass = substitute_all(graph, from->mass, elements, replacements),
                                              .factor = substitute_all(graph, from->factor, elements, replacements)};
  }
  substitute_pivots(graph, inertia, result, replacements);
  return result;
}

static struct FactorPattern pattern_of(const struct InertiaBlock *block) {
  return (struct FactorPattern){block->count, block->start, block->column};
}

void block_factor(struct Graph *graph, struct InertiaBlock *block) {
  const struct FactorPattern pattern = pattern_of(block);
  block->factor = factors_create(graph, &pattern, block->mass);
}

/* Sherman-Morrison update of x for a column added to K, that of a force; response is the solution for the column. */
static void take_response(struct Graph *graph, size_t count, const Node *response, size_t force, Node *x) {
  Node own = divide(graph, x[force], add(graph, ONE, response[force]));
  for (size_t i = 0; i < count; i++) x[i] = subtract(graph, x[i], multiply(graph, response[i], own));
}

/* Solves with the columns of nonsymmetric.h added to K, one after the other. */
static void solve_with_columns(struct Graph *graph, const struct InertiaBlock *block, Node *x) {
  const struct FactorPattern pattern = pattern_of(block);
  size_t n = block->count;
  Node *responses = allocate(block->force_count * n, sizeof *responses);
  factors_solve(graph, &pattern, block->factor, x);
  for (size_t k = 0; k < block->force_count; k++) {
    Node *response = responses + k * n;
    for (size_t i = 0; i < n; i++) response[i] = block->nonsymmetric[k * n + i];
    factors_solve(graph, &pattern, block->factor, response);
    for (size_t j = 0; j < k; j++) take_response(graph, n, responses + j * n, block->forces[j], response);
    take_response(graph, n, response, block->forces[k], x);
  }
}

void block_solve(struct Graph *graph, const struct InertiaBlock *block, Node *x) {
  if (block->tree != NULL) articulated_solve(graph, block->tree, x);
  else solve_with_columns(graph, block, x);
}

void inertia_solve(struct Graph *graph, const struct Inertia *inertia, const Node *right_side, Node *solution) {
  Node *x = allocate(inertia->count, sizeof *x);
  for (size_t b = 0; b < inertia->block_count; b++) {
    const struct InertiaBlock *block = &inertia->blocks[b];
    for (size_t i = 0; i < block->count; i++) x[i] = block->is_unrolled ? right_side[block->coordinates[i]] : ZERO;
    if (block->is_unrolled) block_solve(graph, block, x);
    for (size_t i = 0; i < block->count; i++) solution[block->coordinates[i]] = x[i];
  }
}

/* Adds the product with the matrix of a tree. */
static void add_product_of_tree(struct Graph *graph, const struct InertiaBlock *block, const Node *vector, Node *sum) {
  Node *x = allocate(block->count, sizeof *x), *product = allocate(block->count, sizeof *product);
  for (size_t i = 0; i < block->count; i++) x[i] = vector[block->coordinates[i]];
  articulated_add_product(graph, block->tree, x, product);
  for (size_t i = 0; i < block->count; i++) {
    Node *total = &sum[block->coordinates[i]];
    *total = add(graph, *total, product[i]);
  }
}

void inertia_add_product(struct Graph *graph, const struct Inertia *inertia, const Node *vector, Node *sum) {
  for (size_t b = 0; b < inertia->block_count; b++) {
    const struct InertiaBlock *block = &inertia->blocks[b];
    if (block->tree != NULL) add_product_of_tree(graph, block, vector, sum);
    for (size_t row = 0; row < block->count; row++)
      for (size_t k = block->start[row]; k < block->start[row + 1]; k++) {
        size_t i = block->coordinates[row], j = block->coordinates[block->column[k]];
        sum[i] = add(graph, sum[i], multiply(graph, block->mass[k], vector[j]));
        if (i != j) sum[j] = add(graph, sum[j], multiply(graph, block->mass[k], vector[i]));
      }
  }
}

Node inertia_element(const struct Inertia *inertia, size_t i, size_t j) {
  if (inertia->block_of[i] != inertia->block_of[j]) return ZERO;
  const struct InertiaBlock *block = inertia_block_of(inertia, i);
  size_t found = inertia_find(inertia, i, j);
  return found < block->start[block->count] ? block->mass[found] : ZERO;
}

const struct InertiaBlock *inertia_block_of(const struct Inertia *inertia, size_t coordinate) {
  return &inertia->blocks[inertia->block_of[coordinate]];
}

bool inertia_has_trees(const struct Inertia *inertia) {
  bool has = false;
  for (size_t b = 0; inertia != NULL && b < inertia->block_count; b++) has |= inertia->blocks[b].tree != NULL;
  return has;
}

bool block_is_full(const struct InertiaBlock *block) {
  return block->constraint_count == 0 && block->start[block->count] == block->count * (block->count + 1) / 2;
}
