/*
 * Intervals of the search for events. A hill such as exp(-(x/w)^2) may be flat where an interval begins, and lie
 * between its samples. So an interval must be short enough for every elementary function in the indicators.
 *
 * The dense output of any solver gives the states at the Chebyshev nodes of the interval. They determine
 * polynomials u of degree 8 in the time from its middle (L. N. Trefethen: Approximation Theory and Approximation
 * Practice, 2013). Forces and accelerations in the indicators are expanded likewise. An interval of half length h
 * is short enough if
 *
 *   sum over k >= 1 of |u_k| h^k <= c
 *
 * for the argument u of each function, with the bound c of series_limit.h: then the function changes by a factor of at
 * most e^5, and meets no singularity. A polynomial whose last coefficients are not small does not describe the motion,
 * and shortens the interval, too.
 *
 * An attempt costs nine states and a series of order 8. A failed one shortens the interval to between 1/8 and 1/2. So
 * the loop ends, at the resolution of time at the latest.
 */
#include "detection/search_interval.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluation/inputs.h"
#include "evaluation/services.h"
#include "detection/chebyshev.h"
#include "detection/indicators.h"
#include "support/arena.h"

/* Largest ratio of the last coefficients to the range of a polynomial that describes the motion. */
static const double resolved_motion = 1e-3;

/* Rounding error of forces relative to the largest one; more if rounding of the state makes more. */
static const double force_error_bound = 1e-10;

/* An interval from time `from` to time `to`, in s, with its samples. */
struct SearchInterval {
  struct Instance *instance;
  double from, to;
  double *states, *accelerations; /* CHEBYSHEV_NODES rows each */
  double *rounded;                /* a state, and then the accelerations there */
  Series *x, *input, *work;
  const char *function; /* or constraint that limits the interval; NULL for none */
};

size_t search_interval_sample_count(void) {
  return CHEBYSHEV_NODES * (lagrangian.state_count + lagrangian.switches->watched_acceleration_count);
}

/* Computes the states at the nodes of an interval, a row each; NULL if they are not all available. */
static const double *sample_states(struct Instance *instance, double from, double to) {
  double times[CHEBYSHEV_NODES], *states = instance->switching_work;
  chebyshev_times(from, to, times);
  return solver_interpolate(lagrangian.solver, instance, times, CHEBYSHEV_NODES, states) ? states : NULL;
}

static size_t lay_out_interval(struct SearchInterval *interval, double *work) {
  size_t states = lagrangian.state_count, accelerations = lagrangian.switches->watched_acceleration_count;
  struct Arena arena = {(uintptr_t)work};
  ARENA_NUMBERS(&arena, CHEBYSHEV_NODES * states, &interval->states);
  ARENA_NUMBERS(&arena, CHEBYSHEV_NODES * accelerations, &interval->accelerations);
  ARENA_NUMBERS(&arena, states + accelerations, &interval->rounded);
  ARENA_TAKE(&arena, interval->x, states);
  ARENA_TAKE(&arena, interval->input, lagrangian.input_count);
  ARENA_TAKE(&arena, interval->work, lagrangian.switches->watched_rows);
  return (arena.next - (uintptr_t)work) / sizeof(double);
}

size_t search_interval_work_count(void) {
  struct SearchInterval interval;
  return lagrangian.switches->watched_limit == NULL ? 0 : lay_out_interval(&interval, NULL);
}

static struct SearchInterval interval_of(struct Instance *instance, double from, double to) {
  struct SearchInterval interval = {.instance = instance, .from = from, .to = to};
  lay_out_interval(&interval, instance->switching_work);
  return interval;
}

/* Evaluates the accelerations and forces in the indicators, if there are any. False if they do not exist. */
static bool sample_accelerations(const struct SearchInterval *interval) {
  size_t count = lagrangian.switches->watched_acceleration_count;
  for (int node = 0; node < CHEBYSHEV_NODES && count > 0; node++) {
    double time = chebyshev_time(interval->from, interval->to, node);
    struct Point point =
        solver_point(interval->instance, time, interval->states + (size_t)node * lagrangian.state_count);
    double *acceleration = interval->accelerations + (size_t)node * count;
    if (lagrangian.constraints.accelerations == NULL || lagrangian.constraints.accelerations(&point, acceleration) != 0)
      return false;
  }
  return true;
}

/*
 * Returns the largest acceleration or force. A force near 0, where large ones cancel, has the rounding error of this
 * size.
 */
static double largest_acceleration(const struct SearchInterval *interval) {
  size_t count = CHEBYSHEV_NODES * lagrangian.switches->watched_acceleration_count;
  double largest = 0.0;
  for (size_t i = 0; i < count; i++) largest = fmax(largest, fabs(interval->accelerations[i]));
  return largest;
}

/*
 * Returns the rounding error of the accelerations and forces by rounding of the state in the middle. It is large just
 * before a body rolls or rests: the slip direction is then that of a velocity near rounding.
 */
static double error_bound_in_interval(const struct SearchInterval *interval) {
  size_t count = lagrangian.switches->watched_acceleration_count, middle = CHEBYSHEV_NODES / 2;
  const double *state = interval->states + middle * lagrangian.state_count,
               *exact = interval->accelerations + middle * count;
  double *acceleration = interval->rounded + lagrangian.state_count, error_bound = 0.0;
  double time = chebyshev_time(interval->from, interval->to, (int)middle);
  for (int way = 0; way < 2; way++) {
    double factor = round_state(state, way == 1, interval->rounded);
    struct Point point = solver_point(interval->instance, time, interval->rounded);
    if (lagrangian.constraints.accelerations(&point, acceleration) != 0) return 0.0;
    for (size_t i = 0; i < count; i++) error_bound = fmax(error_bound, factor * fabs(acceleration[i] - exact[i]));
  }
  return error_bound;
}

/*
 * Expands a sampled quantity about the middle. Returns its last coefficients in units of those of a polynomial that
 * describes it up to error_bound; INFINITY if it has no value.
 */
static double expand_sampled(const struct SearchInterval *interval, const double *samples, size_t count, size_t i,
                             double error_bound, double *series) {
  double f[CHEBYSHEV_NODES], c[CHEBYSHEV_NODES];
  for (size_t node = 0; node < CHEBYSHEV_NODES; node++) f[node] = samples[node * count + i];
  chebyshev_coefficients(f, c);
  chebyshev_powers(c, 0.5 * (interval->to - interval->from), series);
  double rounding = 64.0 * DBL_EPSILON * fabs(c[0]), tail = chebyshev_tail(c);
  double allowed = resolved_motion * chebyshev_range(c) + fmax(rounding, error_bound);
  if (tail == 0.0) return 0.0;
  return isfinite(tail) ? tail / allowed : INFINITY;
}

/* Expands the states. Returns the largest number of expand_sampled(). */
static double expand_states(const struct SearchInterval *interval) {
  double excess = 0.0;
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    double rounding = 64.0 * DBL_EPSILON * lagrangian.steps.nominal[i];
    excess =
        fmax(excess, expand_sampled(interval, interval->states, lagrangian.state_count, i, rounding, interval->x[i]));
  }
  return excess;
}

/* Does the same for accelerations and forces; interval->function names a constraint whose force has it above 1. */
static double expand_accelerations(struct SearchInterval *interval, double error_bound) {
  size_t count = lagrangian.switches->watched_acceleration_count, n = lagrangian.coordinate_count;
  double most = 0.0;
  interval->function = NULL;
  for (size_t i = 0; i < count; i++) {
    double excess = expand_sampled(interval, interval->accelerations, count, i, error_bound,
                                   interval->work[lagrangian.switches->watched_acceleration_row + i]);
    if (excess > 1.0 && excess > most) interval->function = i >= n ? lagrangian.constraints.names[i - n] : NULL;
    most = fmax(most, excess);
  }
  return most;
}

/* Expands states, accelerations and forces. Returns the largest number of expand_sampled(). */
static double expand_motion(struct SearchInterval *interval) {
  double excess = expand_states(interval);
  if (excess > 1.0) return excess;
  if (!sample_accelerations(interval)) return INFINITY;
  excess = expand_accelerations(interval, force_error_bound * largest_acceleration(interval));
  return excess > 1.0 ? expand_accelerations(interval, error_bound_in_interval(interval)) : excess;
}

/* Returns half the length of an interval about the same middle that hides nothing, or is expected to be resolved. */
static double certain_half(struct SearchInterval *interval) {
  const struct SwitchTable *switches = lagrangian.switches;
  double middle = chebyshev_time(interval->from, interval->to, CHEBYSHEV_NODES / 2);
  size_t states = lagrangian.state_count, forces = switches->watched_acceleration_count;
  double half = 0.5 * (interval->to - interval->from), excess = expand_motion(interval);
  if (excess > 1.0) return half * pow(excess, -1.0 / (CHEBYSHEV_DEGREE - 1)); /* by the last but one coefficient */
  for (size_t i = 0; i < lagrangian.input_count; i++) {
    memset(interval->input[i], 0, sizeof(Series));
    expand_input(interval->instance, i, middle, interval->input[i]);
  }
  struct Point point = solver_point(interval->instance, middle, interval->states + CHEBYSHEV_NODES / 2 * states);
  struct SeriesLimit limit = {.order = CHEBYSHEV_DEGREE, .step = half, .crosses = true, .surrounds = true};
  switches->watched_limit(&point, interval->accelerations + CHEBYSHEV_NODES / 2 * forces,
                          (const Series *)interval->input, (const Series *)interval->x, interval->work, &limit);
  interval->function = limit.function;
  return limit.step;
}

bool search_interval_shorten(struct Instance *instance, double from, double *to, struct IntervalSamples *samples) {
  const struct SwitchTable *switches = lagrangian.switches;
  for (;;) {
    *samples = (struct IntervalSamples){.states = sample_states(instance, from, *to)};
    if (switches->watched_limit == NULL) return true;
    struct SearchInterval interval = interval_of(instance, from, *to);
    double length = *to - from, half = samples->states != NULL ? certain_half(&interval) : 0.0;
    bool is_certain = half >= 0.5 * length;
    if (is_certain && switches->watched_acceleration_count > 0) samples->accelerations = interval.accelerations;
    if (is_certain) return true;
    double shorter = fmin(fmax(2.0 * half, 0.125 * length), 0.5 * length);
    if (shorter <= 16.0 * DBL_EPSILON * fabs(from) || !(from + shorter > from)) {
      instance->limited_by = interval.function;
      return false;
    }
    *to = from + shorter;
  }
}
