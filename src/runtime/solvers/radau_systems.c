#include <math.h>
#include <string.h>

#include "evaluate.h"
#include "radau.h"

static size_t align(size_t doubles) {
  return doubles + doubles % 2;
}

size_t radau_systems_size(void) {
  size_t n = lagrangian.coordinate_count, states = lagrangian.state_count;
  size_t values = align((size_t)lagrangian.jacobian_pattern.count);
  return values + SYSTEM_LIMIT * (2 * n * n + align(n)) + 4 * states;
}

void radau_systems_place(struct RadauSystems *systems, double *memory) {
  size_t n = lagrangian.coordinate_count, states = lagrangian.state_count;
  systems->values = memory;
  memory += align(lagrangian.jacobian_pattern.count);
  for (int j = 0; j < SYSTEM_LIMIT; j++) {
    systems->factors[j] = (struct Complex *)memory;
    memory += 2 * n * n;
    systems->pivots[j] = (size_t *)memory;
    memory += align(n);
  }
  systems->right_side = (struct Complex *)memory;
  systems->solution = systems->right_side + states;
}

bool radau_systems_evaluate(struct Instance *instance, struct RadauSystems *systems, double time, const double *state) {
  struct Point point = solver_point(instance, time, state);
  instance->situation->statistics[STATISTIC_JACOBIANS]++;
  instance->singular = lagrangian.jacobian(&point, systems->values);
  return instance->singular == 0 && are_finite(systems->values, lagrangian.jacobian_pattern.count);
}

static struct Complex times(struct Complex a, struct Complex b) {
  return (struct Complex){a.real * b.real - a.imaginary * b.imaginary, a.real * b.imaginary + a.imaginary * b.real};
}

static struct Complex inverse(struct Complex a) {
  double square = a.real * a.real + a.imaginary * a.imaginary;
  return (struct Complex){a.real / square, -a.imaginary / square};
}

static void subtract_product(struct Complex *sum, struct Complex a, struct Complex b) {
  sum->real -= a.real * b.real - a.imaginary * b.imaginary;
  sum->imaginary -= a.real * b.imaginary + a.imaginary * b.real;
}

/* mu^2 - mu D - K */
static void fill(const struct RadauSystems *systems, struct Complex mu, struct Complex *matrix) {
  const struct Sparsity *pattern = &lagrangian.jacobian_pattern;
  size_t n = lagrangian.coordinate_count;
  struct Complex square = times(mu, mu);
  memset(matrix, 0, n * n * sizeof *matrix);
  for (size_t i = 0; i < n; i++) matrix[i * n + i] = square;
  for (size_t column = 0; column < 2 * n; column++) {
    for (int e = pattern->start[column]; e < pattern->start[column + 1]; e++) {
      size_t row = (size_t)pattern->row[e];
      if (row < n || row >= 2 * n) continue;
      struct Complex *element = &matrix[(row - n) * n + (column < n ? column : column - n)];
      double value = systems->values[e];
      element->real -= column < n ? value : value * mu.real;
      element->imaginary -= column < n ? 0.0 : value * mu.imaginary;
    }
  }
}

static double size_of(struct Complex a) {
  return fabs(a.real) + fabs(a.imaginary);
}

/* Gauss's elimination with row pivots. False where the matrix is singular. */
static bool eliminate(size_t n, struct Complex *matrix, size_t *pivots) {
  for (size_t k = 0; k < n; k++) {
    size_t best = k;
    for (size_t i = k + 1; i < n; i++)
      if (size_of(matrix[i * n + k]) > size_of(matrix[best * n + k])) best = i;
    pivots[k] = best;
    if (!(size_of(matrix[best * n + k]) > 0.0) || !isfinite(size_of(matrix[best * n + k]))) return false;
    for (size_t j = 0; j < n && best != k; j++) {
      struct Complex swapped = matrix[k * n + j];
      matrix[k * n + j] = matrix[best * n + j];
      matrix[best * n + j] = swapped;
    }
    struct Complex scale = inverse(matrix[k * n + k]);
    for (size_t i = k + 1; i < n; i++) {
      struct Complex *row = &matrix[i * n];
      if (row[k].real == 0.0 && row[k].imaginary == 0.0) continue;
      row[k] = times(row[k], scale);
      for (size_t j = k + 1; j < n; j++) subtract_product(&row[j], row[k], matrix[k * n + j]);
    }
  }
  return true;
}

static void substitute(size_t n, const struct Complex *matrix, const size_t *pivots, struct Complex *x) {
  for (size_t k = 0; k < n; k++) {
    struct Complex swapped = x[k];
    x[k] = x[pivots[k]];
    x[pivots[k]] = swapped;
  }
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < i; j++) subtract_product(&x[i], matrix[i * n + j], x[j]);
  for (size_t i = n; i-- > 0;) {
    for (size_t j = i + 1; j < n; j++) subtract_product(&x[i], matrix[i * n + j], x[j]);
    x[i] = times(x[i], inverse(matrix[i * n + i]));
  }
}

bool radau_systems_factor(struct RadauSystems *systems, const struct RadauMethod *method, double step) {
  size_t n = lagrangian.coordinate_count;
  for (int j = 0; j <= method->stages / 2; j++) {
    systems->mu[j] = (struct Complex){method->value_real[j] / step, method->value_imaginary[j] / step};
    fill(systems, systems->mu[j], systems->factors[j]);
    if (!eliminate(n, systems->factors[j], systems->pivots[j])) return false;
  }
  return true;
}

/* sum += the product of the Jacobian's elements in rows first .. end - 1 with x, columns below n or from n on */
static void add_product(const struct RadauSystems *systems, size_t from, size_t to, size_t first, size_t end,
                        const struct Complex *x, double sign, struct Complex *sum) {
  const struct Sparsity *pattern = &lagrangian.jacobian_pattern;
  for (size_t column = from; column < to; column++) {
    for (int e = pattern->start[column]; e < pattern->start[column + 1]; e++) {
      size_t row = (size_t)pattern->row[e];
      if (row < first || row >= end) continue;
      sum[row - first].real += sign * systems->values[e] * x[column - from].real;
      sum[row - first].imaginary += sign * systems->values[e] * x[column - from].imaginary;
    }
  }
}

void radau_systems_solve(struct RadauSystems *systems, int j) {
  size_t n = lagrangian.coordinate_count, states = lagrangian.state_count;
  const struct Complex *right = systems->right_side, mu = systems->mu[j];
  struct Complex *x = systems->solution;
  for (size_t i = 0; i < n; i++) {
    struct Complex product = times(mu, right[i]);
    x[i] = (struct Complex){right[n + i].real + product.real, right[n + i].imaginary + product.imaginary};
  }
  add_product(systems, n, 2 * n, n, 2 * n, right, -1.0, x);
  substitute(n, systems->factors[j], systems->pivots[j], x);
  for (size_t i = 0; i < n; i++) {
    struct Complex product = times(mu, x[i]);
    x[n + i] = (struct Complex){product.real - right[i].real, product.imaginary - right[i].imaginary};
  }
  if (states == 2 * n) return;
  x[2 * n] = right[2 * n];
  add_product(systems, 0, 2 * n, 2 * n, states, x, 1.0, x + 2 * n);
  x[2 * n] = times(x[2 * n], inverse(mu));
}
