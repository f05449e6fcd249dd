#include "mechanics/massless.h"

#include <math.h>

#include "algebra/differentiate.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "mechanics/constraints.h"
#include "mechanics/inertial_forces.h"
#include "mechanics/mass_matrix/pivots.h"

/* Smallest share that a pivot has of its diagonal element, or a sum of its terms, if it is not 0 up to rounding. */
static const double rounding = 1e-10;

/* M and J, as expressions and as numbers. */
struct Matrices {
  const struct Model *model;
  size_t count; /* number of coordinates */
  struct Elements mass;
  struct Constraints *constraints;
  double *values;       /* of all nodes at a generic point, where expressions vanish only if they vanish identically */
  bool *is_regularized; /* of each constraint: it is regularized */
};

static struct Elements mass_elements(const struct Model *model) {
  struct Graph *graph = model->graph;
  size_t n = model->coordinates.count;
  struct Elements elements = {0};
  Node *momentum = allocate(n, sizeof *momentum);
  Node kinetic = add(graph, model->energies.kinetic.node, energy_of_regularization(model));
  gradient_of(graph, subtract(graph, kinetic, model->energies.potential.node), VELOCITY, n, momentum);
  for (size_t i = 0; i < n && graph_limit(graph) == NULL; i++) {
    struct Gradient row = gradient_by_kinds(graph, momentum[i], 1u << VELOCITY);
    for (size_t k = 0; k < row.count; k++) {
      size_t j = (size_t)graph_symbol_of(graph, row.symbols[k])->index;
      if (!model->prescribed.motions[i].is_prescribed && !model->prescribed.motions[j].is_prescribed)
        elements_append(&elements, i, j, row.values[k]);
    }
  }
  return elements;
}

/* Returns the components of coordinates that M couples, with the regularized constraints. */
static struct ConnectedComponents couplings(const struct Matrices *matrices) {
  const struct Elements *jacobian = &matrices->constraints->jacobian;
  size_t *first = allocate(matrices->constraints->count, sizeof *first); /* 1 + a coordinate of each constraint */
  struct Elements all = {0};
  for (size_t k = 0; k < matrices->mass.count; k++)
    elements_append(&all, matrices->mass.positions[k].row, matrices->mass.positions[k].column, ZERO);
  for (size_t k = 0; k < jacobian->count; k++) {
    size_t constraint = jacobian->positions[k].row, coordinate = jacobian->positions[k].column;
    if (!matrices->is_regularized[constraint]) continue;
    if (first[constraint] > 0) elements_append(&all, coordinate, first[constraint] - 1, ZERO);
    first[constraint] = coordinate + 1;
  }
  return find_components(matrices->count, &all);
}

/* Returns the index of each coordinate in its component; counts the coordinates of each component. */
static size_t *indices_in(const struct ConnectedComponents *components, size_t count, size_t *sizes) {
  size_t *indices = allocate(count, sizeof *indices);
  for (size_t i = 0; i < count; i++) indices[i] = sizes[components->of[i]]++;
  return indices;
}

/* Adds M, and j^T j for the row j of each regularized constraint, to the dense matrices of the components. */
static void fill(const struct Matrices *matrices, const struct ConnectedComponents *components, const size_t *indices,
                 const size_t *sizes, double **dense) {
  const struct Elements *mass = &matrices->mass, *jacobian = &matrices->constraints->jacobian;
  for (size_t k = 0; k < mass->count; k++) {
    size_t i = mass->positions[k].row, component = components->of[i];
    dense[component][indices[i] * sizes[component] + indices[mass->positions[k].column]] +=
        matrices->values[mass->nodes[k]];
  }
  for (size_t k = 0; k < jacobian->count; k++) {
    size_t row = jacobian->positions[k].row, i = jacobian->positions[k].column, component = components->of[i];
    for (size_t l = k; matrices->is_regularized[row] && l < jacobian->count && jacobian->positions[l].row == row; l++) {
      size_t j = jacobian->positions[l].column, size = sizes[component];
      double product = matrices->values[jacobian->nodes[k]] * matrices->values[jacobian->nodes[l]];
      dense[component][indices[i] * size + indices[j]] += product;
      if (k != l) dense[component][indices[j] * size + indices[i]] += product;
    }
  }
}

/*
 * Finds a vector z != 0 with m z = 0 for a positive semidefinite m, by L D L^T in place up to the first zero pivot.
 * False if m is regular.
 */
static bool find_null_vector(size_t n, double *m, double *z) {
  for (size_t i = 0; i < n; i++) {
    double *row = m + i * n, diagonal = row[i];
    for (size_t j = 0; j < i; j++)
      for (size_t k = 0; k < j; k++) row[j] -= row[k] * m[j * n + k];
    for (size_t j = 0; j < i; j++) {
      double l = row[j] / m[j * n + j];
      row[i] -= l * row[j];
      row[j] = l;
    }
    if (row[i] > rounding * diagonal) continue;
    for (size_t j = i; j-- > 0;) {
      z[j] = -row[j];
      for (size_t k = j + 1; k < i; k++) z[j] -= m[k * n + j] * z[k];
    }
    z[i] = 1.0;
    return true;
  }
  return false;
}

/* Regularizes the constraints with J z != 0. False if all of them were regularized before. */
static bool regularize_motion(struct Matrices *matrices, const double *z) {
  const struct Elements *jacobian = &matrices->constraints->jacobian;
  bool has_changed = false;
  for (size_t k = 0, end = 0; k < jacobian->count; k = end) {
    size_t row = jacobian->positions[k].row;
    double sum = 0.0, size = 0.0;
    for (end = k; end < jacobian->count && jacobian->positions[end].row == row; end++) {
      double term = matrices->values[jacobian->nodes[end]] * z[jacobian->positions[end].column];
      sum += term;
      size += fabs(term);
    }
    if (matrices->is_regularized[row] || !(fabs(sum) > rounding * size)) continue;
    matrices->is_regularized[row] = has_changed = true;
  }
  return has_changed;
}

/* Regularizes one null vector of each component. False if nothing changed. */
static bool regularize_motions(struct Matrices *matrices) {
  size_t n = matrices->count;
  struct ConnectedComponents components = couplings(matrices);
  size_t *sizes = allocate(components.count, sizeof *sizes), *indices = indices_in(&components, n, sizes);
  double **dense = allocate(components.count, sizeof *dense), *z = allocate(n, sizeof *z),
         *all = allocate(n, sizeof *all);
  bool has_changed = false;
  for (size_t c = 0; c < components.count; c++) dense[c] = allocate(sizes[c] * sizes[c], sizeof **dense);
  fill(matrices, &components, indices, sizes, dense);
  for (size_t c = 0; c < components.count; c++) {
    if (find_null_vector(sizes[c], dense[c], z)) {
      for (size_t i = 0; i < n; i++) all[i] = components.of[i] == c ? z[indices[i]] : 0.0;
      has_changed |= regularize_motion(matrices, all);
      for (size_t i = 0; i < sizes[c]; i++) z[i] = 0.0;
    }
  }
  return has_changed;
}

/* Returns the inertia of a coordinate; its value at the start if it varies in time, and ZERO if there is none. */
static Node inertia_of(const struct Matrices *matrices, size_t coordinate, const double *at_start) {
  struct Graph *graph = matrices->model->graph;
  const struct Elements *mass = &matrices->mass;
  for (size_t k = 0; k < mass->count; k++) {
    if (mass->positions[k].row != coordinate || mass->positions[k].column != coordinate) continue;
    if (graph_is_constant_in_time(graph, mass->nodes[k])) return mass->nodes[k];
    double value = at_start[mass->nodes[k]];
    return isfinite(value) && value > 0.0 ? graph_constant(graph, value) : ZERO;
  }
  return ZERO;
}

static Node *inertias_of(const struct Matrices *matrices, const double *at_start) {
  Node *inertias = allocate(matrices->count, sizeof *inertias);
  for (size_t i = 0; i < matrices->count; i++) inertias[i] = inertia_of(matrices, i, at_start);
  return inertias;
}

/*
 * Returns 1 / (sum of 1 / inertia) over the coordinates with inertia in the row. If it has none, returns the inertia of
 * the first coordinate that has one, or 1.
 */
static Node harmonic_inertia(const struct Matrices *matrices, size_t row, const Node *inertias) {
  struct Graph *graph = matrices->model->graph;
  const struct Elements *jacobian = &matrices->constraints->jacobian;
  Node sum = ZERO;
  for (size_t k = 0; k < jacobian->count; k++) {
    Node inertia = inertias[jacobian->positions[k].column];
    if (jacobian->positions[k].row == row && inertia != ZERO) sum = add(graph, sum, power_number(graph, inertia, -1.0));
  }
  for (size_t i = 0; i < matrices->count && sum == ZERO; i++)
    if (inertias[i] != ZERO) sum = power_number(graph, inertias[i], -1.0);
  return sum != ZERO ? power_number(graph, sum, -1.0) : ONE;
}

/* Returns the square of the norm of a row of J at the start; 1 if that is 0 or not finite. */
static double square_of_row(const struct Matrices *matrices, size_t row, const double *at_start) {
  const struct Elements *jacobian = &matrices->constraints->jacobian;
  double square = 0.0;
  for (size_t k = 0; k < jacobian->count; k++)
    if (jacobian->positions[k].row == row) square += at_start[jacobian->nodes[k]] * at_start[jacobian->nodes[k]];
  return isfinite(square) && square > 0.0 ? square : 1.0;
}

/*
 * Appends the regularizations. Each inertia is about the smallest that its constraint couples. A larger one would swamp
 * that by its rounding errors; a smaller one would cost digits of the forces on coordinates without inertia.
 */
static void append_regularizations(const struct Matrices *matrices, struct Model *model) {
  struct Graph *graph = model->graph;
  double *symbols = start_values(model), *at_start = graph_evaluate(graph, symbols);
  Node *inertias = inertias_of(matrices, at_start);
  for (size_t j = 0; j < model->constraints.count; j++) {
    if (!matrices->is_regularized[j]) continue;
    Node inertia = harmonic_inertia(matrices, j, inertias);
    APPEND(model->mechanism.regularizations, model->mechanism.regularization_count,
           (struct Regularization){model->constraints.items[j].node,
                                   scale(graph, 1.0 / square_of_row(matrices, j, at_start), inertia)});
  }
}

/* Returns the values of all nodes for random symbols, at which M and J are finite if eight trials find such. */
static double *generic_values(const struct Matrices *matrices, const struct Graph *graph) {
  double *symbols = allocate(graph->symbol_count, sizeof *symbols), *values = NULL;
  uint64_t seed = 1;
  bool is_finite = false;
  for (int trial = 0; trial < 8 && !is_finite; trial++) {
    for (size_t i = 0; i < graph->symbol_count; i++) symbols[i] = next_random(&seed);
    values = graph_evaluate(graph, symbols);
    is_finite = true;
    for (size_t k = 0; k < matrices->mass.count; k++) is_finite &= isfinite(values[matrices->mass.nodes[k]]) != 0;
    for (size_t k = 0; k < matrices->constraints->jacobian.count; k++)
      is_finite &= isfinite(values[matrices->constraints->jacobian.nodes[k]]) != 0;
  }
  return values;
}

void regularize_massless_coordinates(struct Model *model) {
  if (model->constraints.count == 0 || graph_limit(model->graph) != NULL) return;
  struct Matrices matrices = {.model = model,
                              .count = model->coordinates.count,
                              .mass = mass_elements(model),
                              .constraints = constraints_derive(model),
                              .is_regularized = allocate(model->constraints.count, sizeof(bool))};
  matrices.values = generic_values(&matrices, model->graph);
  bool any = false;
  while (regularize_motions(&matrices)) any = true;
  if (any) append_regularizations(&matrices, model);
}
