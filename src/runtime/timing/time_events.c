/*
 * Time events: zeros of branches that depend on time, parameters and modes only.
 *
 * Between events an affine branch is f(t) = a + b t. Newton's method t - f(t) / b gives its zero from any t in one
 * step. Near the zero f(t) is an exact difference of close numbers, so a second step gives the double next to -a / b.
 *
 * The first zero of other branches, such as sin(3 t) - 1/2, is searched in one interval after another, as in
 * search.c. The coefficients of the Chebyshev polynomial bound f over an interval. Intervals begin short, and are
 * doubled while f is resolved. A pulse between the nodes of an interval, as of exp(-1e6 (t - 5)^2), can be missed.
 */
#include "timing/time_events.h"

#include <float.h>
#include <math.h>

#include "detection/chebyshev.h"
#include "detection/search.h"
#include "instance/time_laws.h"
#include "timing/samples.h"

/* Newton steps: one to the zero, and two that remove its rounding error. */
enum { ZERO_STEPS = 3 };

/* Intervals in a search for a zero, which then takes about a millisecond: each has 9 evaluations. */
enum { TIME_INTERVAL_LIMIT = 400 };

/* Length of the first interval, in s or relative to the time. */
static const double first_length = 1e-3;

/* Rounding error of a value, relative to its size and its change since time 0: a few operations. */
static const double error_of_value = 16.0 * DBL_EPSILON;

/* Evaluates the branches at a time, with accelerations of 0, on which time events do not depend. */
void time_events_values(struct Resolution *resolution, double time) {
  struct Point point = instance_point(resolution->instance);
  point.time = time;
  resolution_values_of_force(resolution, &point, lagrangian.constraints.count, 0.0, resolution->value);
}

/* Returns the time in s until the branch reaches 0, from the values at a time; INFINITY if it does not. */
static double time_to_zero(const struct Resolution *resolution, size_t branch) {
  double mode = mode_of(resolution, resolution->switches->branches[branch].mode);
  double value = resolution->value[branch], rate = resolution->value[branch_rate_slot(resolution->switches, branch)];
  double duration = -value / rate;
  return mode * rate < 0.0 && isfinite(duration) ? duration : INFINITY;
}

/* Returns the first of the timed branches up to count that reaches 0 by its tangent; branch_count for none. */
static size_t first_to_switch(const struct Resolution *resolution, size_t count) {
  const struct SwitchTable *switches = resolution->switches;
  size_t first = switches->branch_count;
  double least = INFINITY;
  for (size_t i = 0; i < count; i++) {
    double duration = time_to_zero(resolution, switches->timed[i]);
    if (!(duration < least)) continue;
    least = duration;
    first = switches->timed[i];
  }
  return first;
}

/* Returns the first zero of the branches that are affine in time; INFINITY for none. */
static double next_affine(struct Resolution *resolution, double present) {
  time_events_values(resolution, present);
  size_t branch = first_to_switch(resolution, resolution->switches->affine_count);
  if (branch == resolution->switches->branch_count) return INFINITY;
  const struct SampleMetadata *sample = sample_of(resolution->switches, branch);
  if (sample != NULL) return sample_time(resolution->instance, sample);
  double time = present;
  for (int i = 0; i < ZERO_STEPS; i++) {
    time += time_to_zero(resolution, branch);
    time_events_values(resolution, time);
  }
  return time;
}

/* Returns the value of a branch at a time, with the sign that makes it positive while its mode stays. */
static double value_in_mode(struct Resolution *resolution, size_t branch, double time) {
  time_events_values(resolution, time);
  return mode_of(resolution, resolution->switches->branches[branch].mode) * resolution->value[branch];
}

/* Returns the first time after a fall below 0, by bisection to the resolution of time. */
static double bisect_fall(struct Resolution *resolution, size_t branch, double before, double after) {
  for (;;) {
    double middle = before + 0.5 * (after - before);
    if (middle <= before || middle >= after) return after;
    if (value_in_mode(resolution, branch, middle) < 0.0) after = middle;
    else before = middle;
  }
}

/* Judges whether a branch falls below 0 in an interval. */
static enum Verdict judge_interval(struct Resolution *resolution, size_t branch, double from, double to) {
  double f[CHEBYSHEV_NODES], largest = 0.0;
  for (int node = 0; node < CHEBYSHEV_NODES; node++) {
    f[node] = value_in_mode(resolution, branch, chebyshev_time(from, to, node));
    largest = fmax(largest, fabs(f[node]));
  }
  double rate = resolution->value[branch_rate_slot(resolution->switches, branch)];
  return search_judge(f, error_of_value * (largest + fabs(rate * to)));
}

/*
 * Returns the first fall of a curved branch below 0 in an interval; INFINITY for none. A search of TIME_INTERVAL_LIMIT
 * intervals without a zero returns its end: the importer handles an event without effect there, and the search
 * continues.
 */
static double next_fall(struct Resolution *resolution, size_t branch, double from, double end) {
  double length = first_length * fmax(1.0, fabs(from));
  if (mode_of(resolution, resolution->switches->branches[branch].mode) == 0.0) return INFINITY;
  for (int i = 0; i < TIME_INTERVAL_LIMIT && from < end; i++) {
    double to = fmin(end, from + length);
    enum Verdict verdict = judge_interval(resolution, branch, from, to);
    if (verdict == FALLS) return bisect_fall(resolution, branch, from, to);
    bool is_shortest = to - from <= 8.0 * rounding_of_time(to);
    if (verdict == STAYS || is_shortest) from = to;
    length *= verdict == STAYS ? 2.0 : is_shortest ? 1.0 : 0.5;
  }
  return from < end ? from : INFINITY;
}

static bool find_next_time(struct Instance *instance, double *time) {
  struct Resolution resolution = resolution_of(instance);
  const struct SwitchTable *switches = resolution.switches;
  const struct FmuState *fmu_state = instance->fmu_state;
  double next = next_affine(&resolution, fmu_state->time);
  double last = fmu_state->stop_time_defined ? fmu_state->stop_time : INFINITY;
  for (size_t i = switches->affine_count; i < switches->timed_count; i++)
    next = fmin(next, next_fall(&resolution, switches->timed[i], fmu_state->time, fmin(next, last)));
  *time = fmax(next, fmu_state->time);
  return isfinite(*time);
}

static bool is_due(struct Instance *instance) {
  struct Resolution resolution = resolution_of(instance);
  double present = instance->fmu_state->time;
  time_events_values(&resolution, present);
  size_t branch = first_to_switch(&resolution, resolution.switches->timed_count);
  return branch < resolution.switches->branch_count && time_to_zero(&resolution, branch) <= rounding_of_time(present);
}

const struct TimeLaws time_laws = {.next = find_next_time, .is_due = is_due, .start = samples_start};
