#include "methods/first_terms.h"

#include <math.h>

#include "evaluation/inputs.h"
#include "evaluation/services.h"

size_t first_terms_rows(void) {
  if (lagrangian.taylor.limit == NULL) return 0;
  return lagrangian.state_count + lagrangian.input_count + lagrangian.taylor.rows;
}

/*
 * The series stops at order 3: in stiff systems, higher coefficients belong to fast modes, which the method damps.
 * Kinks, roots and jumps do not limit the step; the method's error estimate finds them.
 */
double first_terms_step(struct Instance *instance, Series *rows, double time, const double *state, double bound) {
  enum { ORDER = 3 };
  if (lagrangian.taylor.limit == NULL) return bound;
  size_t states = lagrangian.state_count;
  Series *x = rows, *input = x + states, *work = input + lagrangian.input_count;
  double *derivative = instance->work + lagrangian.input_count;
  struct Point point = solver_point(instance, time, state);
  if (lagrangian.taylor.start(&point, derivative, work) != 0) return bound;
  for (size_t i = 0; i < states; i++) {
    x[i][0] = state[i];
    x[i][1] = derivative[i];
  }
  for (size_t i = 0; i < lagrangian.input_count; i++) expand_input(instance, i, time, input[i]);
  lagrangian.taylor.series(&point, ORDER, (const Series *)input, x, work);
  int order = ORDER - 1;
  for (size_t i = 0; i < states; i++)
    if (!isfinite(x[i][2])) order = 1; /* at a root of 0, whose first derivative is infinite */
  struct SeriesLimit limit = {.order = order, .step = bound, .crosses = true};
  lagrangian.taylor.limit(&point, (const Series *)input, (const Series *)x, (const Series *)work, &limit);
  return limit.step;
}
