#include "freedom.h"

#include <math.h>

#include "base/memory.h"

/* Pivots below this share of the largest element are rounding errors. */
static const double smallest_pivot = 1e-9;

static bool is_permanent(const struct Model *model, size_t constraint) {
  const struct Switches *switches = &model->switches;
  for (size_t i = 0; i < switches->contact_count; i++)
    if (switches->contacts[i].constraint == constraint) return false;
  for (size_t i = 0; i < switches->friction_count; i++)
    if (switches->frictions[i].constraint == constraint) return false;
  return true;
}

size_t permanent_constraint_count(const struct Model *model) {
  size_t count = 0;
  for (size_t i = 0; i < model->constraints.count; i++) count += is_permanent(model, i);
  return count;
}

/* Subtracts multiples of the row with the pivot from the rows in which it is not yet 0. */
static void clear_column(double *matrix, size_t rows, size_t columns, const bool *done, size_t row, size_t column) {
  for (size_t i = 0; i < rows; i++) {
    double factor = matrix[i * columns + column] / matrix[row * columns + column];
    if (done[i] || i == row) continue;
    for (size_t k = 0; k < columns; k++) matrix[i * columns + k] -= factor * matrix[row * columns + k];
  }
}

static size_t rank_of(double *matrix, size_t rows, size_t columns) {
  bool *done = allocate(rows + 1, sizeof *done);
  double first = 0.0;
  size_t rank = 0;
  for (; rank < rows; rank++) {
    size_t row = 0, column = 0;
    double largest = 0.0;
    for (size_t i = 0; i < rows * columns; i++) {
      if (done[i / columns] || !(fabs(matrix[i]) > largest)) continue;
      largest = fabs(matrix[i]);
      row = i / columns;
      column = i % columns;
    }
    if (rank == 0) first = largest;
    if (largest <= smallest_pivot * first) break;
    clear_column(matrix, rows, columns, done, row, column);
    done[row] = true;
  }
  return rank;
}

size_t constraint_rank(const struct Model *model, const struct Equations *equations) {
  const struct Elements *jacobian = &equations->constraints->jacobian;
  size_t rows = model->constraints.count, columns = equations->count;
  if (permanent_constraint_count(model) == 0 || columns == 0) return 0;
  double *matrix = allocate(rows * columns, sizeof *matrix), *symbols = start_values(model);
  double *values = graph_evaluate(model->graph, symbols);
  for (size_t k = 0; k < jacobian->count; k++) {
    struct Position position = jacobian->positions[k];
    if (is_permanent(model, position.row))
      matrix[position.row * columns + position.column] = values[jacobian->nodes[k]];
  }
  release(values);
  return rank_of(matrix, rows, columns);
}

bool is_unconstrained(const struct Equations *equations, size_t coordinate) {
  const struct Constraints *constraints = equations->constraints;
  for (size_t k = 0; k < constraints->jacobian.count; k++)
    if (constraints->jacobian.positions[k].column == coordinate) return false;
  return true;
}
