#include "mechanics/mass_matrix.h"

#include <math.h>
#include <stdlib.h>

#include "memory.h"
#include "algebra/simplify.h"

static double next_random(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return 0.5 + (double)(*seed >> 11) / 9007199254740992.0;
}

/* The coordinate at which a numeric L D L^T finds M singular, count where it is regular, -1 without a finite M. */
static long singular_coordinate(const struct Equations *equations, const double *values) {
  size_t n = equations->count;
  double *m = allocate(n * n, sizeof *m);
  long result = (long)n;
  for (size_t i = 0; i < n * n; i++) {
    m[i] = values[equations->mass[i]];
    if (!isfinite(m[i])) result = -1;
  }
  for (size_t j = 0; j < n && result == (long)n; j++) {
    if (fabs(m[j * n + j]) <= 1e-10 * fabs(values[equations->mass[j * n + j]])) result = (long)j;
    for (size_t i = j + 1; i < n; i++)
      for (size_t k = j + 1; k <= i; k++) m[i * n + k] -= m[i * n + j] * m[k * n + j] / m[j * n + j];
  }
  free(m);
  return result;
}

bool mass_matrix_check(const struct Model *model, const struct Equations *equations, struct Diagnostics *diagnostics) {
  const struct Graph *graph = model->graph;
  size_t n = equations->count;
  bool regular = true;
  for (size_t i = 0; i < n; i++) {
    if (equations->mass[i * n + i] != ZERO) continue;
    report_error(diagnostics, model->coordinates.items[i].line,
                 "the coordinate '%s' has no inertia: no mass moves with it; expected a <particle>, <body> or "
                 "<kinetic> that depends on it",
                 model->coordinates.items[i].name);
    regular = false;
  }
  double *symbols = allocate(graph->symbol_count, sizeof *symbols);
  uint64_t seed = 1;
  long singular = -1, found = -1;
  for (int trial = 0; trial < 8 && regular && found != (long)n; trial++) {
    for (size_t i = 0; i < graph->symbol_count; i++) symbols[i] = next_random(&seed);
    double *values = graph_evaluate(graph, symbols);
    found = singular_coordinate(equations, values);
    if (found >= 0 && found < (long)n) singular = found;
    free(values);
  }
  free(symbols);
  if (regular && singular >= 0 && found != (long)n) {
    report_error(diagnostics, model->coordinates.items[singular].line,
                 "the mass matrix is structurally singular: the motion along '%s' is not independent of the other "
                 "coordinates; expected one coordinate for each degree of freedom",
                 model->coordinates.items[singular].name);
    regular = false;
  }
  return regular;
}

/* Coordinates coupled by M, directly or by way of others, are of one block. */
static void find_blocks(struct Equations *equations) {
  size_t n = equations->count, *stack = allocate(n, sizeof *stack);
  equations->block = allocate(n, sizeof *equations->block);
  for (size_t i = 0; i < n; i++) equations->block[i] = n;
  for (size_t first = 0; first < n; first++) {
    if (equations->block[first] != n) continue;
    size_t depth = 0;
    stack[depth++] = first;
    equations->block[first] = equations->block_count;
    while (depth > 0) {
      size_t i = stack[--depth];
      for (size_t j = 0; j < n; j++) {
        if (equations->block[j] != n || equations->mass[i * n + j] == ZERO) continue;
        equations->block[j] = equations->block_count;
        stack[depth++] = j;
      }
    }
    equations->block_count++;
  }
  free(stack);
}

enum { MAGNITUDE_DEPTH = 8 };

/* An upper bound of |node| that shares its structure, with |sin|, |cos| <= 1. */
static Node magnitude(struct Graph *graph, Node node, int depth) {
  const struct Vertex vertex = graph->vertices[node];
  if (depth == MAGNITUDE_DEPTH) return node;
  depth++;
  switch (vertex.operation) {
  case SINE:
  case COSINE: return ONE;
  case ADD: return add(graph, magnitude(graph, vertex.left, depth), magnitude(graph, vertex.right, depth));
  case MULTIPLY: return multiply(graph, magnitude(graph, vertex.left, depth), magnitude(graph, vertex.right, depth));
  case CONSTANT: return graph_constant(graph, fabs(vertex.value));
  case POWER: {
    bool positive = graph_is_constant(graph, vertex.right) && graph_value(graph, vertex.right) > 0;
    return positive ? power(graph, magnitude(graph, vertex.left, depth), vertex.right) : node;
  }
  default: return node;
  }
}

/* The trigonometric factors of a diagonal element can vanish where the motion is regular (poles). */
static Node pivot_scale(struct Graph *graph, Node diagonal) {
  Node terms[TERM_LIMIT], scale = ZERO;
  int count = terms_of(graph, diagonal, terms, TERM_LIMIT);
  if (count == TERM_LIMIT) return diagonal;
  for (int i = 0; i < count; i++) scale = add(graph, scale, magnitude(graph, terms[i], 0));
  return scale;
}

static void add_pivot(struct Graph *graph, struct Equations *equations, size_t i) {
  Node diagonal = equations->mass[i * equations->count + i];
  equations->pivots[equations->pivot_count++] = (struct Pivot){
      .value = equations->diagonal[i], .diagonal = diagonal, .scale = pivot_scale(graph, diagonal), .coordinate = i};
}

/* D_j = M_jj - sum_k L_jk^2 D_k,  L_ij = (M_ij - sum_k L_ik L_jk D_k) / D_j */
static void factor_block(struct Graph *graph, struct Equations *equations, size_t block) {
  size_t n = equations->count;
  for (size_t i = 0; i < n; i++) {
    if (equations->block[i] != block) continue;
    Node pivot = equations->mass[i * n + i];
    for (size_t j = 0; j < i; j++) {
      if (equations->block[j] != block) continue;
      Node product = equations->mass[i * n + j]; /* L_ij D_j */
      for (size_t k = 0; k < j; k++) {
        if (equations->block[k] != block) continue;
        Node part = multiply(graph, equations->lower[i * n + k], equations->diagonal[k]);
        product = subtract(graph, product, multiply(graph, part, equations->lower[j * n + k]));
      }
      equations->lower[i * n + j] = divide(graph, product, equations->diagonal[j]);
      pivot = subtract(graph, pivot, multiply(graph, equations->lower[i * n + j], product));
    }
    equations->diagonal[i] = pivot;
    add_pivot(graph, equations, i);
  }
}

void equations_solve(struct Graph *graph, const struct Equations *equations, const Node *right_side, Node *solution) {
  size_t n = equations->count;
  for (size_t i = 0; i < n; i++) {
    solution[i] = equations->unrolled[equations->block[i]] ? right_side[i] : ZERO;
    for (size_t k = 0; k < i; k++)
      solution[i] = subtract(graph, solution[i], multiply(graph, equations->lower[i * n + k], solution[k]));
  }
  for (size_t i = n; i-- > 0;) {
    if (!equations->unrolled[equations->block[i]]) continue;
    solution[i] = divide(graph, solution[i], equations->diagonal[i]);
    for (size_t k = i + 1; k < n; k++)
      solution[i] = subtract(graph, solution[i], multiply(graph, equations->lower[k * n + i], solution[k]));
  }
}

void mass_matrix_factor(struct Model *model, struct Equations *equations) {
  size_t n = equations->count;
  bool unroll_all = model->linearized || (model->method != NULL && model->method->needs_linear);
  find_blocks(equations);
  equations->unrolled = allocate(equations->block_count, sizeof *equations->unrolled);
  equations->lower = allocate(n * n, sizeof *equations->lower);
  equations->diagonal = allocate(n, sizeof *equations->diagonal);
  equations->pivots = allocate(n, sizeof *equations->pivots);
  for (size_t block = 0; block < equations->block_count; block++) {
    size_t size = 0;
    for (size_t i = 0; i < n; i++) size += equations->block[i] == block;
    equations->unrolled[block] = unroll_all || size <= UNROLL_LIMIT;
    if (equations->unrolled[block]) factor_block(model->graph, equations, block);
  }
  equations_solve(model->graph, equations, equations->right_side, equations->acceleration);
  for (size_t i = 0; i < n; i++)
    if (!equations->unrolled[equations->block[i]]) equations->acceleration[i] = model->accelerations[i];
}

bool block_is_looped(const struct Equations *equations, size_t block) {
  return !equations->explicit_form && !equations->unrolled[block];
}

bool is_looped(const struct Equations *equations, size_t coordinate) {
  return !equations->explicit_form && !equations->unrolled[equations->block[coordinate]];
}

bool has_loops(const struct Equations *equations) {
  for (size_t block = 0; block < equations->block_count; block++)
    if (block_is_looped(equations, block)) return true;
  return false;
}
