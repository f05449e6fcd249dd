/*
 * Windows for the search for events. A hill such as exp(-(x/w)^2) may be flat where a window begins, and lie between
 * its samples. So a window must be short enough for every elementary function in the indicators.
 *
 * The states at the Chebyshev nodes of the window, by the dense output of any solver, give polynomials u of degree 8 in
 * the time from its middle (L. N. Trefethen: Approximation Theory and Approximation Practice, 2013). Forces and
 * accelerations in the indicators are expanded likewise. A window of half length h is short enough if
 *
 *   sum over k >= 1 of |u_k| h^k <= c
 *
 * for the argument u of each function, with the bound c of series_limit.h: then the function changes by a factor of at
 * most e^5, and meets no singularity. A polynomial whose last coefficients are not small does not describe the motion,
 * and shortens the window, too.
 *
 * An attempt costs nine states and a series of order 8. A failed one shortens the window to between 1/8 and 1/2. So the
 * loop ends, at the resolution of time at the latest.
 */
#include "events/window.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluation/inputs.h"
#include "evaluation/services.h"
#include "events/chebyshev.h"
#include "events/indicators.h"

/* Largest ratio of the last coefficients to the range of a polynomial that describes the motion. */
static const double resolved_motion = 1e-3;

/* Rounding error of forces relative to the largest one; more if rounding of the state makes more. */
static const double force_error_bound = 1e-10;

/* A window from time `from` to time `to`, in s, with its samples. */
struct Window {
  struct Instance *instance;
  double from, to;
  double *states, *accelerations; /* CHEBYSHEV_NODES rows each */
  double *rounded;                /* a state, and then the accelerations there */
  Series *x, *input, *work;
  const char *function; /* or constraint that limits the window; NULL for none */
};

size_t window_sample_count(void) {
  return CHEBYSHEV_NODES * lagrangian.state_count;
}

/* Computes the states at the nodes of a window, a row each; NULL if they are not all available. */
static const double *sample_states(struct Instance *instance, double from, double to) {
  double times[CHEBYSHEV_NODES], *states = instance->switching_work;
  chebyshev_times(from, to, times);
  return solver_interpolate(lagrangian.solver, instance, times, CHEBYSHEV_NODES, states) ? states : NULL;
}

size_t window_work_count(void) {
  const struct SwitchTable *switches = lagrangian.switches;
  if (switches->watched_limit == NULL) return 0;
  return window_sample_count() + (CHEBYSHEV_NODES + 1) * switches->watched_acceleration_count + lagrangian.state_count +
         SERIES_LENGTH * (lagrangian.state_count + lagrangian.input_count + switches->watched_rows);
}

static struct Window window_of(struct Instance *instance, double from, double to) {
  const struct SwitchTable *switches = lagrangian.switches;
  struct Window window = {.instance = instance, .from = from, .to = to, .states = instance->switching_work};
  window.accelerations = window.states + CHEBYSHEV_NODES * lagrangian.state_count;
  window.rounded = window.accelerations + CHEBYSHEV_NODES * switches->watched_acceleration_count;
  window.x = (Series *)(window.rounded + lagrangian.state_count + switches->watched_acceleration_count);
  window.input = window.x + lagrangian.state_count;
  window.work = window.input + lagrangian.input_count;
  return window;
}

/* Evaluates the accelerations and forces in the indicators, if there are any. False if they do not exist. */
static bool sample_accelerations(const struct Window *window) {
  size_t count = lagrangian.switches->watched_acceleration_count;
  for (int node = 0; node < CHEBYSHEV_NODES && count > 0; node++) {
    double time = chebyshev_time(window->from, window->to, node);
    struct Point point = solver_point(window->instance, time, window->states + (size_t)node * lagrangian.state_count);
    double *acceleration = window->accelerations + (size_t)node * count;
    if (lagrangian.constraints.accelerations == NULL || lagrangian.constraints.accelerations(&point, acceleration) != 0)
      return false;
  }
  return true;
}

/*
 * Returns the largest acceleration or force. A force near 0, where large ones cancel, has the rounding error of this
 * size.
 */
static double largest_acceleration(const struct Window *window) {
  size_t count = CHEBYSHEV_NODES * lagrangian.switches->watched_acceleration_count;
  double largest = 0.0;
  for (size_t i = 0; i < count; i++) largest = fmax(largest, fabs(window->accelerations[i]));
  return largest;
}

/*
 * Returns the rounding error of the accelerations and forces by rounding of the state in the middle. It is large just
 * before a body rolls or rests: the slip direction is then that of a velocity near rounding.
 */
static double error_bound_in_window(const struct Window *window) {
  size_t count = lagrangian.switches->watched_acceleration_count, middle = CHEBYSHEV_NODES / 2;
  const double *state = window->states + middle * lagrangian.state_count,
               *exact = window->accelerations + middle * count;
  double *acceleration = window->rounded + lagrangian.state_count, error_bound = 0.0;
  double time = chebyshev_time(window->from, window->to, (int)middle);
  for (int way = 0; way < 2; way++) {
    double factor = round_state(state, way == 1, window->rounded);
    struct Point point = solver_point(window->instance, time, window->rounded);
    if (lagrangian.constraints.accelerations(&point, acceleration) != 0) return 0.0;
    for (size_t i = 0; i < count; i++) error_bound = fmax(error_bound, factor * fabs(acceleration[i] - exact[i]));
  }
  return error_bound;
}

/* Expands a sampled quantity about the middle. False if its polynomial does not describe it up to error_bound. */
static bool expand_sampled(const struct Window *window, const double *samples, size_t count, size_t i,
                           double error_bound, double *series) {
  double f[CHEBYSHEV_NODES], c[CHEBYSHEV_NODES];
  for (size_t node = 0; node < CHEBYSHEV_NODES; node++) f[node] = samples[node * count + i];
  chebyshev_coefficients(f, c);
  chebyshev_powers(c, 0.5 * (window->to - window->from), series);
  double rounding = 64.0 * DBL_EPSILON * fabs(c[0]);
  return chebyshev_tail(c) <= resolved_motion * chebyshev_range(c) + fmax(rounding, error_bound);
}

/* Expands the accelerations and forces. False if one is not resolved; window->function names a constraint's force. */
static bool expand_accelerations(struct Window *window, double error_bound) {
  size_t count = lagrangian.switches->watched_acceleration_count, i = count;
  bool is_resolved = true;
  while (i > 0 && is_resolved) {
    i--;
    is_resolved = expand_sampled(window, window->accelerations, count, i, error_bound,
                                 window->work[lagrangian.switches->watched_acceleration_row + i]);
  }
  bool is_force = !is_resolved && i >= lagrangian.coordinate_count;
  window->function = is_force ? lagrangian.constraints.names[i - lagrangian.coordinate_count] : NULL;
  return is_resolved;
}

/* Returns half the length of a window about the same middle that hides nothing; 0 if unknown. */
static double sure_half(struct Window *window) {
  const struct SwitchTable *switches = lagrangian.switches;
  double middle = chebyshev_time(window->from, window->to, CHEBYSHEV_NODES / 2);
  size_t states = lagrangian.state_count, forces = switches->watched_acceleration_count;
  bool is_resolved = sample_accelerations(window);
  for (size_t i = 0; i < states && is_resolved; i++)
    is_resolved = expand_sampled(window, window->states, states, i, 64.0 * DBL_EPSILON * lagrangian.steps.nominal[i],
                                 window->x[i]);
  double error_bound = is_resolved ? force_error_bound * largest_acceleration(window) : 0.0;
  if (!is_resolved ||
      !(expand_accelerations(window, error_bound) || expand_accelerations(window, error_bound_in_window(window))))
    return 0.0;
  for (size_t i = 0; i < lagrangian.input_count; i++) {
    memset(window->input[i], 0, sizeof(Series));
    expand_input(window->instance, i, middle, window->input[i]);
  }
  struct Point point = solver_point(window->instance, middle, window->states + CHEBYSHEV_NODES / 2 * states);
  struct SeriesLimit limit = {
      .order = CHEBYSHEV_DEGREE, .step = 0.5 * (window->to - window->from), .crosses = true, .surrounds = true};
  switches->watched_limit(&point, window->accelerations + CHEBYSHEV_NODES / 2 * forces, (const Series *)window->input,
                          (const Series *)window->x, window->work, &limit);
  window->function = limit.function;
  return limit.step;
}

bool window_narrow(struct Instance *instance, double from, double *to, const double **samples) {
  for (;;) {
    *samples = sample_states(instance, from, *to);
    if (lagrangian.switches->watched_limit == NULL) return true;
    struct Window window = window_of(instance, from, *to);
    double length = *to - from, half = *samples != NULL ? sure_half(&window) : 0.0;
    if (half >= 0.5 * length) return true;
    double shorter = fmin(fmax(2.0 * half, 0.125 * length), 0.5 * length);
    if (shorter <= 16.0 * DBL_EPSILON * fabs(from) || !(from + shorter > from)) {
      instance->limited_by = window.function;
      return false;
    }
    *to = from + shorter;
  }
}
