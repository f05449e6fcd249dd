/*
 * Compares the Jacobian matrix of a generated system, which is linked in, with directional derivatives of its right
 * side. Prints the number of states, that of elements of the pattern, and the largest difference relative to the
 * largest element. Random points have coordinates and velocities between -1 and 1.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "lagrangian.h"

enum { POINTS = 20 };

/* Returns a uniform random number between -1 and 1, the same on all platforms. */
static double draw(void) {
  static unsigned long seed = 1;
  seed = (seed * 1103515245ul + 12345ul) & 0x7ffffffful;
  return (double)seed / 0x3fffffff - 1.0;
}

static double *zeros(size_t count) {
  double *values = calloc(count + 1, sizeof *values);
  if (values == NULL) exit(2);
  return values;
}

/* Returns element (row, j); *k is the index of the first element of column j in this row or below, and advances. */
static double element(const double *values, size_t row, size_t j, int *k) {
  const struct Sparsity *pattern = &lagrangian.implicit.pattern;
  if (*k == pattern->start[j + 1] || (size_t)pattern->row[*k] != row) return 0.0;
  return values[(*k)++];
}

int main(void) {
  size_t states = lagrangian.state_count, count = lagrangian.implicit.pattern.count;
  double *parameter = zeros(lagrangian.parameter_count),
         *parameter_constants = zeros(lagrangian.parameter_constants_count);
  double *input = zeros(lagrangian.input_count), *work = zeros(lagrangian.work_count);
  double *state = zeros(states), *along = zeros(states), *column = zeros(states), *values = zeros(count);
  for (size_t i = 0; i < lagrangian.variable_count; i++)
    if (lagrangian.variables[i].kind == VARIABLE_PARAMETER)
      parameter[lagrangian.variables[i].index] = lagrangian.variables[i].start;
  if (lagrangian.prepare(parameter, parameter_constants) != 0) return 1;
  struct Point point = {
      .state = state, .input = input, .parameter = parameter, .parameter_constants = parameter_constants, .work = work};
  double *no_input = zeros(lagrangian.input_count), *no_parameter = zeros(lagrangian.parameter_count);
  struct Seed seed = {.state = along, .input = no_input, .parameter = no_parameter};
  double largest = 0.0, difference = 0.0;
  for (int n = 0; n < POINTS; n++) {
    for (size_t i = 0; i < states; i++) state[i] = draw();
    if (lagrangian.implicit.jacobian(&point, values) != 0) return 1;
    for (size_t j = 0; j < states; j++) {
      int k = lagrangian.implicit.pattern.start[j];
      along[j] = 1.0;
      if (lagrangian.directional(&point, &seed, column) != 0) return 1;
      along[j] = 0.0;
      for (size_t i = 0; i < states; i++) {
        largest = fmax(largest, fabs(column[i]));
        difference = fmax(difference, fabs(element(values, i, j, &k) - column[i]));
      }
      if (k != lagrangian.implicit.pattern.start[j + 1]) return 1;
    }
  }
  printf("%zu %zu %g\n", states, count, difference / largest);
  double *const arrays[] = {parameter, parameter_constants, input, work, state, along, column, values,
                            no_input,  no_parameter};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) free(arrays[i]);
  return 0;
}
