/*
 * The Jacobian d(derivatives)/d(state), exact. With R = M a - b = 0, each column of the accelerations solves
 *
 *     M da/dx_j = -dR/dx_j   at constant a.
 *
 * One reverse sweep for each row of R gives its gradient, so that only nonzero elements are formed. The columns are
 * then solved symbolically in small blocks, and by the factors of M at run time in others. For kinematic trees,
 * directional derivatives along each state (forward mode) are cheaper. Only the pattern is found here, from the
 * states that each block depends on. The same holds for long equations, such as those of a robot on the ground with
 * hundreds of contact points. The number of elements is bounded by JACOBIAN_LIMIT. A. Griewank, A. Walther: Evaluating
 * Derivatives, 2nd ed., 2008, chapters 3 and 7.
 */
#include "program/expressions/jacobian.h"

#include <stdlib.h>

#include "algebra/cone.h"
#include "algebra/differentiate.h"
#include "algebra/simplify.h"
#include "base/memory.h"

/*
 * Most nodes below the equations, counted once for each: for formulas, and for those that are not compared with
 * directions. The C of formulas has some 30 bytes a node.
 */
enum { GRADIENT_LIMIT = 100000, DIRECTIONS_LIMIT = 20000 };

/* The kinds of symbols of the state, as bits. */
enum { STATE_KINDS = 1 << COORDINATE | 1 << VELOCITY | 1 << STATE };

/* An element of the Jacobian, at a row and column of the state. */
struct JacobianElement {
  struct Position at;
  Node value;
};

struct JacobianElements {
  struct JacobianElement *items;
  size_t count;
};

static void append(struct JacobianElements *list, size_t row, size_t column, Node value) {
  APPEND(list->items, list->count, (struct JacobianElement){{row, column}, value});
}

static size_t column_of(const struct Graph *graph, size_t coordinates, Node symbol) {
  return state_slot(coordinates, graph_symbol_of(graph, symbol));
}

static void append_gradient(struct JacobianElements *list, struct Graph *graph, size_t coordinates, Node target,
                            size_t row) {
  struct Gradient gradient = gradient_by_kinds(graph, target, STATE_KINDS);
  for (size_t i = 0; i < gradient.count; i++)
    append(list, row, column_of(graph, coordinates, gradient.symbols[i]), gradient.values[i]);
}

/* Appends one column of a block: its solution, or right sides if the block is factored at run time. */
static void append_column(struct JacobianElements *list, struct Graph *graph, const struct Equations *equations,
                          const struct InertiaBlock *block, size_t column, Node *right) {
  if (block->is_unrolled) block_solve(graph, block, right);
  for (size_t i = 0; i < block->count; i++) {
    size_t row = block->coordinates[i];
    if (row >= equations->count) row += equations->rates.count; /* constraint rows follow all states */
    if (!block->is_unrolled || right[i] != ZERO) append(list, equations->count + row, column, right[i]);
  }
}

static void append_block(struct JacobianElements *list, struct Graph *graph, const struct Equations *equations,
                         const struct InertiaBlock *block) {
  struct JacobianElements residual = {0};
  for (size_t i = 0; i < block->count; i++)
    append_gradient(&residual, graph, equations->count, equations->residual[block->coordinates[i]], i);
  if (residual.count > 0) qsort(residual.items, residual.count, sizeof *residual.items, compare_positions);
  Node *right = allocate(block->count, sizeof *right);
  for (size_t first = 0, next = 0; first < residual.count && list->count <= JACOBIAN_LIMIT; first = next) {
    size_t column = residual.items[first].at.column;
    for (size_t i = 0; i < block->count; i++) right[i] = ZERO;
    for (; next < residual.count && residual.items[next].at.column == column; next++)
      right[residual.items[next].at.row] = negate(graph, residual.items[next].value);
    append_column(list, graph, equations, block, column, right);
  }
}

/* Sorts the elements into compressed columns. Rows beyond the states are constraint rows. */
static struct JacobianExpressions *by_columns(struct JacobianElements *list, size_t columns) {
  struct JacobianExpressions *jacobian = allocate(1, sizeof *jacobian);
  if (list->count > 0) qsort(list->items, list->count, sizeof *list->items, compare_positions);
  jacobian->start = allocate(columns + 1, sizeof *jacobian->start);
  jacobian->row = allocate(list->count, sizeof *jacobian->row);
  jacobian->value = allocate(list->count, sizeof *jacobian->value);
  jacobian->right_sides = allocate(list->count, sizeof *jacobian->right_sides);
  for (size_t i = 0; i < list->count; i++) {
    const struct JacobianElement *element = &list->items[i];
    if (element->at.row >= columns) {
      struct ConstraintRightSide right_side = {element->at.column, element->at.row - columns, element->value};
      jacobian->right_sides[jacobian->right_side_count++] = right_side;
      continue;
    }
    jacobian->start[element->at.column + 1]++;
    jacobian->row[jacobian->count] = element->at.row;
    jacobian->value[jacobian->count++] = element->value;
  }
  for (size_t j = 0; j < columns; j++) jacobian->start[j + 1] += jacobian->start[j];
  return jacobian;
}

/* Collects in the graph's cone all nodes that the equations of the block depend on. */
static void collect_block(struct Graph *graph, const struct Equations *equations, const struct InertiaBlock *block) {
  Node *residuals = allocate(block->count, sizeof *residuals);
  for (size_t i = 0; i < block->count; i++) residuals[i] = equations->residual[block->coordinates[i]];
  cone_collect(graph->cone, graph, residuals, block->count);
}

static bool is_symbol_of(const struct Graph *graph, Node node, unsigned kinds) {
  return graph->vertices[node].operation == SYMBOL && (graph->vertices[node].kinds & kinds) != 0;
}

/* Appends the pattern of a block: each state that its equations depend on, in all its rows. */
static void append_pattern(struct JacobianElements *list, struct Graph *graph, const struct Equations *equations,
                           const struct InertiaBlock *block) {
  const struct Cone *cone = graph->cone;
  collect_block(graph, equations, block);
  for (size_t k = 0; k < cone->count && list->count <= JACOBIAN_LIMIT; k++) {
    Node node = cone->nodes[k];
    bool is_state = is_symbol_of(graph, node, STATE_KINDS);
    for (size_t i = 0; i < block->count && is_state; i++)
      if (block->coordinates[i] < equations->count)
        append(list, equations->count + block->coordinates[i], column_of(graph, equations->count, node), ONE);
  }
}

/* Marks the columns of the states in the cone. */
static void mark_columns(const struct Graph *graph, size_t coordinates, bool *is_marked) {
  const struct Cone *cone = graph->cone;
  for (size_t k = 0; k < cone->count; k++)
    if (is_symbol_of(graph, cone->nodes[k], STATE_KINDS))
      is_marked[column_of(graph, coordinates, cone->nodes[k])] = true;
}

/* Appends the pattern of first-order states. A rate that depends on an acceleration depends on its block's states. */
static void append_pattern_of_rates(struct JacobianElements *list, struct Graph *graph,
                                    const struct Equations *equations) {
  size_t n = equations->count, states = 2 * n + equations->rates.count;
  for (size_t i = 0; i < equations->rates.count; i++) {
    bool *is_marked = allocate(states, sizeof *is_marked),
         *has_block = allocate(equations->inertia->block_count, sizeof *has_block);
    cone_collect(graph->cone, graph, &equations->rates.nodes[i], 1);
    mark_columns(graph, n, is_marked);
    for (size_t k = 0; k < graph->cone->count; k++)
      if (is_symbol_of(graph, graph->cone->nodes[k], 1u << ACCELERATION))
        has_block[equations->inertia->block_of[graph_symbol_of(graph, graph->cone->nodes[k])->index]] = true;
    for (size_t b = 0; b < equations->inertia->block_count; b++) {
      if (!has_block[b]) continue;
      collect_block(graph, equations, &equations->inertia->blocks[b]);
      mark_columns(graph, n, is_marked);
    }
    for (size_t column = 0; column < states; column++)
      if (is_marked[column]) append(list, 2 * n + i, column, ONE);
  }
}

/* Appends the rows of the first-order states. */
static void append_rates(struct JacobianElements *list, struct Graph *graph, const struct Equations *equations) {
  for (size_t i = 0; i < equations->rates.count; i++)
    append_gradient(list, graph, equations->count, equations->rates.nodes[i], 2 * equations->count + i);
}

/*
 * Returns only the pattern, for a Jacobian by directional derivatives. They serve kinematic trees, where they cost
 * less than formulas for each element, long equations, and rates that depend on values found at run time.
 */
static struct JacobianExpressions *pattern_for_directions(struct Graph *graph, const struct Equations *equations) {
  struct JacobianElements list = {0};
  size_t n = equations->count;
  for (size_t i = 0; i < n; i++) append(&list, i, n + i, ONE);
  for (size_t i = 0; i < equations->inertia->block_count; i++)
    append_pattern(&list, graph, equations, &equations->inertia->blocks[i]);
  append_pattern_of_rates(&list, graph, equations);
  if (list.count > JACOBIAN_LIMIT) return NULL;
  struct JacobianExpressions *jacobian = by_columns(&list, 2 * n + equations->rates.count);
  jacobian->value = NULL;
  return jacobian;
}

/*
 * True if gradients of all equations would be too long, or long and longer than a directional derivative along each
 * state. A gradient takes up to four times the operations of its equation, a directional derivative about as many as
 * all equations.
 */
static bool are_long(struct Graph *graph, const struct Equations *equations) {
  size_t sum = 0, columns = 2 * equations->count + equations->rates.count;
  for (size_t i = 0; i < row_count(equations) && sum <= GRADIENT_LIMIT; i++) {
    cone_collect(graph->cone, graph, &equations->residual[i], 1);
    sum += graph->cone->count;
  }
  if (sum <= DIRECTIONS_LIMIT || sum > GRADIENT_LIMIT) return sum > GRADIENT_LIMIT;
  cone_collect(graph->cone, graph, equations->residual, row_count(equations));
  return 4 * sum > columns * graph->cone->count;
}

static bool needs_directions(struct Graph *graph, const struct Equations *equations) {
  return inertia_has_trees(equations->inertia) || rates_use_unknowns(graph, equations) || are_long(graph, equations);
}

struct JacobianExpressions *jacobian_create(struct Graph *graph, const struct Equations *equations) {
  if (!equations->explicit_form && needs_directions(graph, equations)) return pattern_for_directions(graph, equations);
  struct JacobianElements list = {0};
  size_t n = equations->count;
  for (size_t i = 0; i < n; i++) append(&list, i, n + i, ONE);
  for (size_t i = 0; equations->explicit_form && i < n; i++)
    append_gradient(&list, graph, n, equations->acceleration[i], n + i);
  for (size_t i = 0; !equations->explicit_form && i < equations->inertia->block_count; i++)
    append_block(&list, graph, equations, &equations->inertia->blocks[i]);
  append_rates(&list, graph, equations);
  struct JacobianExpressions *jacobian =
      list.count > JACOBIAN_LIMIT ? NULL : by_columns(&list, 2 * n + equations->rates.count);
  return jacobian;
}

/*
 * Sparse LU for implicit methods. The stage systems of Radau IIA, with the coordinates eliminated, have the matrices
 *
 *     mu^2 - mu df/dv - df/dq
 *
 * for several complex mu, where f are the accelerations; rows of first-order states have mu in place of mu^2. All
 * share one pattern: the elements of df/dv and df/dq, made symmetric, and the diagonal. A minimum-degree elimination
 * (mechanics/mass_matrix/elimination.h) gives the order and the fill-in. T. A. Davis: Direct Methods for Sparse Linear
 * Systems, 2006, chapter 7.
 */

/* Finds the positions in the lower triangle of the symmetric pattern, each once and sorted. Returns their number. */
static size_t find_positions(const struct JacobianExpressions *jacobian, size_t coordinates, size_t rows,
                             struct Position *positions) {
  size_t found = 0, count = 0;
  for (size_t column = 0; column < coordinates + rows; column++) {
    for (size_t e = jacobian->start[column]; e < jacobian->start[column + 1]; e++) {
      if (jacobian->row[e] < coordinates) continue;
      size_t i = jacobian->row[e] - coordinates, j = column < coordinates ? column : column - coordinates;
      positions[found++] = (struct Position){i < j ? j : i, i < j ? i : j};
    }
  }
  for (size_t i = 0; i < rows; i++) positions[found++] = (struct Position){i, i};
  qsort(positions, found, sizeof *positions, compare_positions);
  for (size_t i = 0; i < found; i++)
    if (i == 0 || compare_positions(&positions[i - 1], &positions[i]) != 0) positions[count++] = positions[i];
  return count;
}

/* True if sparse factors are cheaper. Measured on chains of masses, springs and dampers. */
static bool is_sparse(const struct Elimination *pattern, size_t rows) {
  return rows >= 16 && pattern->start[rows] <= rows * rows / 6;
}

struct Elimination *lu_pattern_create(const struct Graph *graph, const struct JacobianExpressions *jacobian,
                                      size_t coordinates, size_t rows) {
  struct Position *positions = allocate(jacobian->count + rows, sizeof *positions);
  struct Elimination *pattern = allocate(1, sizeof *pattern);
  *pattern = eliminate(graph, rows, NULL, positions, find_positions(jacobian, coordinates, rows, positions));
  return is_sparse(pattern, rows) ? pattern : NULL;
}
