#include "mechanics/mass_matrix/pivots.h"

#include <math.h>

#include "algebra/simplify.h"
#include "base/memory.h"

double next_random(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return 0.5 + (double)(*seed >> 11) / 9007199254740992.0;
}

/* The kind of pivot that ends a numerical factorization L D L^T. */
enum PivotFailure { SINGULAR, NOT_POSITIVE };

/*
 * Factors a block numerically. Returns the coordinate of the first pivot that is 0, or with NOT_POSITIVE also negative;
 * count, the number of all rows, if there is none. *sign is the sign of the last pivot, 0 for a zero one. A pivot is 0
 * up to rounding if it is below 1e-10 of its diagonal element.
 */
static size_t end_in_block(const struct InertiaBlock *block, const double *values, size_t count,
                           enum PivotFailure ending, int *sign) {
  const size_t *start = block->start, *column = block->column;
  double *factor = allocate(start[block->count], sizeof *factor), *row = allocate(block->count, sizeof *row);
  size_t found = count;
  for (size_t i = 0; i < block->count && found == count; i++) {
    size_t diagonal = start[i + 1] - 1;
    double pivot = values[block->mass[diagonal]];
    for (size_t k = start[i]; k < diagonal; k++) row[column[k]] = values[block->mass[k]];
    for (size_t k = start[i]; k < diagonal; k++) { /* row[j] becomes L_ij D_j */
      size_t j = column[k], end = start[j + 1] - 1;
      for (size_t l = start[j]; l < end; l++) row[j] -= row[column[l]] * factor[l];
    }
    for (size_t k = start[i]; k < diagonal; k++) {
      size_t j = column[k];
      factor[k] = row[j] / factor[start[j + 1] - 1];
      pivot -= factor[k] * row[j];
      row[j] = 0.0;
    }
    factor[diagonal] = pivot;
    *sign = fabs(pivot) <= 1e-10 * fabs(values[block->mass[diagonal]]) ? 0 : pivot > 0 ? 1 : -1;
    if (*sign == 0 || (*sign < 0 && ending == NOT_POSITIVE)) found = block->coordinates[i];
  }
  return found;
}

/* Factors all blocks without a tree; returns as end_in_block(), or -1 if an element of M is not finite. */
static long ending_coordinate(const struct Inertia *inertia, const double *values, enum PivotFailure ending,
                              int *sign) {
  size_t found = inertia->count;
  for (size_t b = 0; b < inertia->block_count; b++) {
    const struct InertiaBlock *block = &inertia->blocks[b];
    for (size_t k = 0; k < block->start[block->count]; k++)
      if (!isfinite(values[block->mass[k]])) return -1;
  }
  for (size_t b = 0; b < inertia->block_count && found == inertia->count; b++)
    if (inertia->blocks[b].tree == NULL)
      found = end_in_block(&inertia->blocks[b], values, inertia->count, ending, sign);
  return (long)found;
}

/* True if M couples the coordinate, which has no diagonal element, with others. */
static bool has_coupled_inertia(const struct Inertia *inertia, size_t coordinate) {
  const struct InertiaBlock *block = inertia_block_of(inertia, coordinate);
  for (size_t i = 0; i < block->count; i++)
    if (inertia_element(inertia, coordinate, block->coordinates[i]) != ZERO) return true;
  return false;
}

static bool has_all_inertias(const struct Model *model, const struct Inertia *inertia,
                             struct Diagnostics *diagnostics) {
  bool complete = true;
  for (size_t i = 0; i < inertia->count; i++) {
    if (inertia_block_of(inertia, i)->tree != NULL || inertia_element(inertia, i, i) != ZERO) continue;
    if (has_coupled_inertia(inertia, i))
      report_error(diagnostics, model->coordinates.items[i].line,
                   "the kinetic energy has no term with the square of '%s', but products with other velocities: it is "
                   "not positive definite; expected one that is positive for every motion",
                   model->velocities.items[i].name);
    else
      report_error(diagnostics, model->coordinates.items[i].line,
                   "the coordinate '%s' has no inertia: no mass moves with it; expected a <particle>, <body> or "
                   "<kinetic> that depends on it, or constraints that determine its motion",
                   model->coordinates.items[i].name);
    complete = false;
  }
  return complete;
}

/* True unless M has a negative pivot at the start values. A zero pivot, as at a pole, is allowed there. */
static bool is_positive_at_start(const struct Model *model, const struct Inertia *inertia,
                                 struct Diagnostics *diagnostics) {
  double *symbols = start_values(model), *values = graph_evaluate(model->graph, symbols);
  int sign = 0;
  long found = ending_coordinate(inertia, values, NOT_POSITIVE, &sign);
  if (found < 0 || found == (long)inertia->count || sign == 0) return true;
  report_error(
      diagnostics, model->coordinates.items[found].line,
      "the kinetic energy is not positive definite at the start values: it is negative for a motion along '%s'; "
      "expected masses, inertias and <kinetic> that are positive for every motion",
      model->coordinates.items[found].name);
  return false;
}

bool pivots_check(const struct Model *model, const struct Inertia *inertia, struct Diagnostics *diagnostics) {
  const struct Graph *graph = model->graph;
  if (!has_all_inertias(model, inertia, diagnostics)) return false;
  double *symbols = allocate(graph->symbol_count, sizeof *symbols);
  uint64_t seed = 1;
  long regular = (long)inertia->count, singular = -1, found = -1;
  int sign;
  for (int trial = 0; trial < 8 && found != regular; trial++) {
    for (size_t i = 0; i < graph->symbol_count; i++) symbols[i] = next_random(&seed);
    double *values = graph_evaluate(graph, symbols);
    found = ending_coordinate(inertia, values, SINGULAR, &sign);
    if (found >= 0 && found < regular) singular = found;
  }
  if (found == regular || singular < 0) return is_positive_at_start(model, inertia, diagnostics);
  report_error(diagnostics, model->coordinates.items[singular].line,
               "the mass matrix is singular: the velocity of '%s' is not independent of the others; expected one "
               "coordinate for each degree of freedom, or constraints that determine its motion",
               model->velocities.items[singular].name);
  return false;
}

/*
 * Smallest relative pivot of a regular tree. Rounding leaves less of a zero pivot; the first of n links in a row has a
 * relative pivot of about n^-3.
 */
static const double least_share = 1e-13;

/* Returns the smallest ratio of a pivot of the tree to its scale; NAN if one is not finite. */
static double smallest_share_in(const struct ArticulatedTree *tree, size_t coordinate_count, const double *values) {
  double smallest = 1.0;
  for (size_t i = 0; i < tree->count; i++) {
    const struct ArticulatedLink *item = &tree->items[i];
    for (size_t k = 0; k < item->link->count; k++) {
      size_t diagonal = item->pattern.start[k + 1] - 1;
      if (item->link->coordinates[k] >= coordinate_count) continue; /* a constraint */
      double share = values[item->factor[diagonal]] / fabs(values[item->scale[k]]);
      if (!isfinite(share)) return NAN;
      smallest = fmin(smallest, share);
    }
  }
  return smallest;
}

bool tree_has_factors(const struct Model *model, const struct ArticulatedTree *tree) {
  const struct Graph *graph = model->graph;
  double *symbols = allocate(graph->symbol_count, sizeof *symbols);
  uint64_t seed = 1;
  size_t n = model->coordinates.count;
  bool is_regular = false;
  for (int trial = 0; trial < 8 && !is_regular; trial++) {
    for (size_t i = 0; i < graph->symbol_count; i++) symbols[i] = next_random(&seed);
    is_regular = smallest_share_in(tree, n, graph_evaluate(graph, symbols)) > least_share;
  }
  bool is_negative = smallest_share_in(tree, n, graph_evaluate(graph, start_values(model))) < -least_share;
  return is_regular && !is_negative;
}

/* Depth of the bound of an element, which is evaluated at run time and must stay short. */
enum { MAGNITUDE_DEPTH = 8 };

/*
 * Returns an upper bound of |node| to a limited depth, with |sin| and |cos| as 1. It shares the structure of the node.
 */
static Node magnitude(struct Graph *graph, Node node, int depth) {
  const struct Vertex vertex = graph->vertices[node];
  if (depth == MAGNITUDE_DEPTH) return node;
  depth++;
  switch (vertex.operation) {
  case SINE:
  case COSINE: return ONE;
  case ADD:
  case MULTIPLY: {
    Node right = magnitude(graph, vertex.right, depth), left = magnitude(graph, vertex.left, depth);
    return vertex.operation == ADD ? add(graph, left, right) : multiply(graph, left, right);
  }
  case CONSTANT: return graph_constant(graph, fabs(vertex.value));
  case POWER: {
    bool positive = graph_is_constant(graph, vertex.right) && graph_value(graph, vertex.right) > 0;
    return positive ? power(graph, magnitude(graph, vertex.left, depth), vertex.right) : node;
  }
  default: return node;
  }
}

/*
 * Returns a scale for the pivots of a diagonal element. Its trigonometric factors count as 1, since they may vanish
 * where the motion is regular.
 */
static Node pivot_scale(struct Graph *graph, Node diagonal) {
  Node terms[TERM_LIMIT], scale = ZERO;
  int count = terms_of(graph, diagonal, terms, TERM_LIMIT);
  if (count == TERM_LIMIT) return diagonal;
  for (int i = 0; i < count; i++) scale = add(graph, scale, magnitude(graph, terms[i], 0));
  return scale;
}

static void append_pivot(struct Inertia *inertia, size_t coordinate, Node value, Node diagonal, Node scale) {
  if (value == ONE || coordinate >= inertia->coordinate_count) return; /* as the pivots of prescribed coordinates are */
  inertia->pivots[inertia->pivot_count++] =
      (struct Pivot){.value = value, .diagonal = diagonal, .scale = scale, .coordinate = coordinate};
}

/* Appends the pivots of a tree, in the order of elimination. */
static void append_pivots_of_tree(struct Inertia *inertia, const struct InertiaBlock *block) {
  for (size_t i = block->tree->count; i-- > 0;) {
    const struct ArticulatedLink *item = &block->tree->items[i];
    for (size_t k = 0; k < item->link->count; k++) {
      size_t diagonal = item->pattern.start[k + 1] - 1;
      append_pivot(inertia, item->link->coordinates[k], item->factor[diagonal], item->scale[k], item->scale[k]);
    }
  }
}

void pivots_factor(struct Graph *graph, struct Inertia *inertia) {
  inertia->pivots = allocate(inertia->count, sizeof *inertia->pivots);
  for (size_t b = 0; b < inertia->block_count; b++) {
    struct InertiaBlock *block = &inertia->blocks[b];
    if (block->tree != NULL) append_pivots_of_tree(inertia, block);
    if (!block->is_unrolled || block->tree != NULL) continue;
    block_factor(graph, block);
    for (size_t i = 0; i < block->count; i++) {
      size_t diagonal = block->start[i + 1] - 1;
      Node element = block->mass[diagonal];
      append_pivot(inertia, block->coordinates[i], block->factor[diagonal], element, pivot_scale(graph, element));
    }
  }
}
