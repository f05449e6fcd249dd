/*
 * Time events. The indicator of a timed branch is f(t) = a + b t, with a and b constant between events. Newton's method
 * t - f(t) / b gives its zero from any t in one step. Near the zero f(t) is an exact difference of close numbers, so a
 * second step gives the double next to -a / b.
 */
#include "timing/time_events.h"

#include <math.h>

#include "instance/time_laws.h"
#include "timing/samples.h"

/* Newton steps: one to the zero, and two that remove its rounding error. */
enum { ZERO_STEPS = 3 };

/* Evaluates with accelerations of 0. */
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

/* Returns the branch that reaches 0 first; branch_count for none. */
static size_t first_to_switch(const struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  size_t first = switches->branch_count;
  double least = INFINITY;
  for (size_t i = 0; i < switches->timed_count; i++) {
    double duration = time_to_zero(resolution, switches->timed[i]);
    if (!(duration < least)) continue;
    least = duration;
    first = switches->timed[i];
  }
  return first;
}

static bool find_next_time(struct Instance *instance, double *time) {
  struct Resolution resolution = resolution_of(instance);
  double present = instance->fmu_state->time;
  time_events_values(&resolution, present);
  size_t branch = first_to_switch(&resolution);
  if (branch == resolution.switches->branch_count) return false;
  const struct SampleMetadata *sample = sample_of(resolution.switches, branch);
  *time = sample != NULL ? sample_time(instance, sample) : present;
  for (int i = 0; i < ZERO_STEPS && sample == NULL; i++) {
    *time += time_to_zero(&resolution, branch);
    time_events_values(&resolution, *time);
  }
  *time = fmax(*time, present);
  return isfinite(*time);
}

static bool is_due(struct Instance *instance) {
  struct Resolution resolution = resolution_of(instance);
  double present = instance->fmu_state->time;
  time_events_values(&resolution, present);
  size_t branch = first_to_switch(&resolution);
  return branch < resolution.switches->branch_count && time_to_zero(&resolution, branch) <= rounding_of_time(present);
}

const struct TimeLaws time_laws = {.next = find_next_time, .is_due = is_due, .start = samples_start};
