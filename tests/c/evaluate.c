/*
 * Prints the results of the functions of a generated system, which is linked in, at a point and along a direction.
 * Reads both from standard input: time, state, inputs and parameters.
 */
#include <stdio.h>
#include <stdlib.h>

#include "lagrangian.h"

enum { ORDER = 10 };

static void *zeros(size_t count, size_t size) {
  void *values = calloc(count + 1, size);
  if (values == NULL) exit(2);
  return values;
}

/* Returns an array of count numbers, the first of which are read from standard input. */
static double *read_numbers(size_t count, size_t read) {
  double *numbers = zeros(count, sizeof *numbers);
  for (size_t i = 0; i < read; i++)
    if (scanf("%lf", &numbers[i]) != 1) exit(3);
  return numbers;
}

static void print(const char *name, const double *values, size_t count) {
  printf("%s", name);
  for (size_t i = 0; i < count; i++) printf(" %.17g", values[i]);
  printf("\n");
}

static void print_jacobian(const struct Point *point) {
  const struct Sparsity *pattern = &lagrangian.implicit.pattern;
  double *values = zeros(pattern->count, sizeof *values), *column = zeros(lagrangian.state_count, sizeof *column);
  if (lagrangian.implicit.jacobian(point, values) != 0) exit(1);
  for (size_t j = 0; j < lagrangian.state_count; j++) {
    for (size_t i = 0; i < lagrangian.state_count; i++) column[i] = 0.0;
    for (int k = pattern->start[j]; k < pattern->start[j + 1]; k++) column[pattern->row[k]] = values[k];
    print("jacobian", column, lagrangian.state_count);
  }
  free(values);
  free(column);
}

static void print_series(const struct Point *point) {
  size_t states = lagrangian.state_count;
  Series *x = zeros(states, sizeof *x), *work = zeros(lagrangian.taylor.rows, sizeof *work);
  Series *input = zeros(lagrangian.input_count, sizeof *input);
  double *derivative = zeros(states, sizeof *derivative);
  if (lagrangian.taylor.start(point, derivative, work) != 0) exit(1);
  print("start", derivative, states);
  for (size_t i = 0; i < states; i++) {
    x[i][0] = point->state[i];
    x[i][1] = derivative[i];
  }
  for (size_t i = 0; i < lagrangian.input_count; i++) input[i][0] = point->input[i];
  lagrangian.taylor.series(point, ORDER, (const Series *)input, x, work);
  for (size_t i = 0; i < states; i++) print("series", x[i], ORDER + 1);
  free(x);
  free(work);
  free(input);
  free(derivative);
}

/* Sets the modes of branches to the signs of their indicators, which may depend on one another. */
static void set_modes(const struct Point *point, double *parameter) {
  const struct SwitchTable *switches = lagrangian.switches;
  double *indicator = zeros(indicator_count(switches), sizeof *indicator);
  for (size_t round = 0; switches != NULL && round <= switches->branch_count; round++) {
    if (lagrangian.prepare(parameter, (double *)point->parameter_constants) != 0) exit(1);
    switches->indicators(point, NULL, indicator);
    for (size_t i = 0; i < switches->branch_count; i++)
      parameter[switches->branches[i].mode] = (double)((indicator[i] > 0.0) - (indicator[i] < 0.0));
  }
  free(indicator);
}

int main(void) {
  size_t states = lagrangian.state_count, inputs = lagrangian.input_count, parameters = lagrangian.parameter_count;
  size_t modes = lagrangian.switches != NULL ? lagrangian.switches->mode_count : 0;
  size_t count = 1 + states + inputs + parameters, n = lagrangian.coordinate_count;
  double *at = read_numbers(count, count - modes), *direction = read_numbers(count, count - modes);
  double *parameter_constants = zeros(lagrangian.parameter_constants_count, sizeof *parameter_constants);
  double *work = zeros(lagrangian.work_count, sizeof *work);
  double *derivative = zeros(states, sizeof *derivative), *along = zeros(states, sizeof *along);
  double *parameter = at + 1 + states + inputs;
  struct Point point = {at[0], at + 1, at + 1 + states, parameter, parameter_constants, work};
  struct Seed seed = {direction[0], direction + 1, direction + 1 + states, direction + 1 + states + inputs};
  set_modes(&point, parameter);
  if (lagrangian.prepare(parameter, parameter_constants) != 0 || lagrangian.derivatives(&point, derivative) != 0 ||
      lagrangian.directional(&point, &seed, along) != 0)
    return 1;
  print("derivatives", derivative, states);
  print("directional", along, states);
  for (size_t i = 0; i < lagrangian.variable_count; i++) {
    const struct ScalarVariable *variable = &lagrangian.variables[i];
    if (variable->kind != VARIABLE_RESULT) continue;
    double value = lagrangian.results.result(&point, derivative + n, variable->index);
    print(variable->name, &value, 1);
    if (!variable->is_output) continue;
    value = lagrangian.results.result_along(&point, &seed, derivative + n, along + n, variable->index);
    print("along", &value, 1);
  }
  if (lagrangian.implicit.jacobian != NULL) print_jacobian(&point);
  else print_series(&point);
  double *const arrays[] = {at, direction, parameter_constants, work, derivative, along};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) free(arrays[i]);
  return 0;
}
