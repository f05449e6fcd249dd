/*
 * Prints the seconds that one evaluation of the derivatives of a generated system takes, which is linked in:
 * accelerations COUNT. The state changes between evaluations; its values do not affect the time.
 */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "lagrangian.h"

static void *zeros(size_t count, size_t size) {
  void *values = calloc(count + 1, size);
  if (values == NULL) exit(2);
  return values;
}

static double seconds(void) {
  return (double)clock() / CLOCKS_PER_SEC;
}

/* Sets the start values, with all joints displaced and moving. */
static void set_point(double *state, double *parameter) {
  for (size_t i = 0; i < lagrangian.variable_count; i++) {
    const struct ScalarVariable *variable = &lagrangian.variables[i];
    if (variable->kind == VARIABLE_PARAMETER) parameter[variable->index] = variable->start;
    if (variable->kind != VARIABLE_STATE) continue;
    state[variable->index] = variable->start + (variable->index < lagrangian.coordinate_count ? 0.3 : 0.1);
  }
}

int main(int count, char **words) {
  const long evaluations = count == 2 ? strtol(words[1], NULL, 10) : 0;
  if (evaluations < 1) return 2;
  double *state = zeros(lagrangian.state_count, sizeof *state), *input = zeros(lagrangian.input_count, sizeof *input);
  double *parameter = zeros(lagrangian.parameter_count, sizeof *parameter);
  double *parameter_constants = zeros(lagrangian.parameter_constants_count, sizeof *parameter_constants);
  double *work = zeros(lagrangian.work_count, sizeof *work);
  double *derivative = zeros(lagrangian.state_count + lagrangian.constraints.count, sizeof *derivative);
  set_point(state, parameter);
  if (lagrangian.prepare(parameter, parameter_constants) != 0) return 1;
  const struct Point point = {0.0, state, input, parameter, parameter_constants, work};
  const size_t n = lagrangian.coordinate_count;
  const double begin = seconds();
  for (long k = 0; k < evaluations; k++) {
    state[n - 1] += 1e-9;
    if (lagrangian.derivatives(&point, derivative) != 0) return 1;
    state[2 * n - 1] = 0.1 + 1e-9 * derivative[n];
  }
  printf("%g\n", (seconds() - begin) / (double)evaluations);
  double *const arrays[] = {state, input, parameter, parameter_constants, work, derivative};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) free(arrays[i]);
  return 0;
}
