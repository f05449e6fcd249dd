/*
 * Newton's method for the underdetermined system g(q) = 0, with the step of least norm:
 *
 *     dq = -J^T (J J^T)^-1 g,   J = dg/dq.
 *
 * It converges quadratically near a regular point, and stops at |g| < 1e-13, or after a step from |g| < 1e-11;
 * otherwise it fails after MOST_STEPS. A step costs O(n^2 m + n^3) with n constraints and m coordinates. P. Deuflhard:
 * Newton Methods for Nonlinear Problems, 2004.
 */
#include "configurations.h"

#include <math.h>

#include "algebra/cone.h"
#include "algebra/differentiate.h"
#include "algebra/node_list.h"
#include "base/memory.h"
#include "least_squares.h"

/* Coordinates up to which constraints are taken into account: all their derivatives are formed. */
enum { MOST_COORDINATES = 200 };

/* True if the constraint belongs to a contact or friction, and so holds only at times. */
static bool belongs_to_switch(const struct Switches *switches, size_t constraint) {
  bool belongs = false;
  for (size_t i = 0; i < switches->contact_count; i++) belongs |= switches->contacts[i].constraint == constraint;
  for (size_t i = 0; i < switches->friction_count; i++) belongs |= switches->frictions[i].constraint == constraint;
  return belongs;
}

bool holds_positions(const struct Model *model, size_t constraint) {
  Node node = model->constraints.items[constraint].node;
  return !graph_depends_on(model->graph, node, VELOCITY) && !graph_depends_on(model->graph, node, ACCELERATION) &&
         graph_depends_on(model->graph, node, COORDINATE) && !belongs_to_switch(&model->switches, constraint);
}

static void find_levels(struct Configurations *found) {
  const struct Model *model = found->model;
  size_t count = model->constraints.count, coordinates = model->coordinates.count;
  if (coordinates > MOST_COORDINATES) return;
  found->level = allocate(count + 1, sizeof *found->level);
  found->slope = allocate(count + 1, sizeof *found->slope);
  for (size_t j = 0; j < count; j++) {
    if (!holds_positions(model, j)) continue;
    Node *slopes = allocate(coordinates, sizeof *slopes);
    gradient_of(model->graph, model->constraints.items[j].node, COORDINATE, coordinates, slopes);
    found->level[found->count] = model->constraints.items[j].node;
    found->slope[found->count++] = slopes;
  }
}

struct Configurations configurations_of(const struct Model *model, const struct NodeList *wanted) {
  struct Configurations found = {.model = model};
  find_levels(&found);
  if (wanted == NULL) return found;
  struct NodeList targets = {.count = 0};
  append_nodes(&targets, wanted->nodes, wanted->count);
  for (size_t i = 0; i < found.count; i++) {
    append_node(&targets, found.level[i]);
    append_nodes(&targets, found.slope[i], model->coordinates.count);
  }
  struct Cone *cone = cone_create();
  cone_collect(cone, model->graph, targets.nodes, targets.count);
  found.part = cone->nodes;
  found.part_count = cone->count;
  return found;
}

static bool can_move(const struct Model *model, size_t coordinate) {
  bool is_prescribed = model->prescribed.motion_count > 0 && model->prescribed.motions[coordinate].is_prescribed;
  return !is_prescribed && !model->coordinates.items[coordinate].is_fixed;
}

/* Subtracts J^T (J J^T)^-1 g from the coordinates that can move. Returns the largest |g| before the step. */
static double step(const struct Configurations *levels, const double *values, double *symbols) {
  const struct Model *model = levels->model;
  size_t n = levels->count, coordinates = model->coordinates.count;
  double *pull = allocate(n + 1, sizeof *pull), largest = 0.0;
  struct LeastSquares system = least_squares_create(n, n);
  for (size_t i = 0; i < n; i++) {
    double *row = least_squares_row(&system, i);
    row[n] = values[levels->level[i]];
    largest = fmax(largest, fabs(row[n]));
    for (size_t j = 0; j < n; j++)
      for (size_t k = 0; k < coordinates; k++)
        if (can_move(model, k)) row[j] += values[levels->slope[i][k]] * values[levels->slope[j][k]];
  }
  least_squares_solve(&system, 0, pull);
  for (size_t k = 0; k < coordinates; k++)
    for (size_t i = 0; i < n && can_move(model, k); i++)
      symbols[model->graph->vertices[model->coordinates.items[k].node].left] -= values[levels->slope[i][k]] * pull[i];
  release(system.entries);
  release(pull);
  return largest;
}

static double *evaluate(const struct Configurations *configurations, const double *symbols) {
  const struct Graph *graph = configurations->model->graph;
  if (configurations->part == NULL) return graph_evaluate(graph, symbols);
  double *values = allocate(graph->count, sizeof *values);
  graph_evaluate_part(graph, configurations->part, configurations->part_count, symbols, values);
  return values;
}

double *values_at(const struct Configurations *configurations, const double *offsets) {
  /* Newton steps; a few suffice near a solution, and more than 30 mean divergence. */
  enum { MOST_STEPS = 30 };
  const struct Model *model = configurations->model;
  double *symbols = start_values(model);
  for (size_t k = 0; k < model->coordinates.count && offsets != NULL; k++)
    symbols[model->graph->vertices[model->coordinates.items[k].node].left] += offsets[k];
  double *values = evaluate(configurations, symbols);
  for (int i = 0; i < MOST_STEPS && configurations->count > 0; i++) {
    double largest = step(configurations, values, symbols);
    if (largest < 1e-13) return values;
    release(values);
    values = evaluate(configurations, symbols);
    if (!isfinite(largest)) return NULL;
    if (largest < 1e-11) return values;
  }
  return configurations->count == 0 ? values : NULL;
}
