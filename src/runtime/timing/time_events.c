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
void time_events_values(struct Settlement *settlement, double time) {
  struct Point point = instance_point(settlement->instance);
  point.time = time;
  settlement_values_of_force(settlement, &point, lagrangian.constraints.count, 0.0, settlement->value);
}

/* Returns the time in s until the branch reaches 0, from the values at a time; INFINITY if it does not. */
static double time_to_zero(const struct Settlement *settlement, size_t branch) {
  double mode = mode_of(settlement, settlement->switches->branches[branch].mode);
  double value = settlement->value[branch], rate = settlement->value[branch_rate_place(settlement->switches, branch)];
  double duration = -value / rate;
  return mode * rate < 0.0 && isfinite(duration) ? duration : INFINITY;
}

/* Returns the branch that reaches 0 first; branch_count for none. */
static size_t first_to_turn(const struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  size_t first = switches->branch_count;
  double least = INFINITY;
  for (size_t i = 0; i < switches->timed_count; i++) {
    double duration = time_to_zero(settlement, switches->timed[i]);
    if (!(duration < least)) continue;
    least = duration;
    first = switches->timed[i];
  }
  return first;
}

static bool find_next_time(struct Instance *instance, double *time) {
  struct Settlement settlement = settlement_of(instance);
  double present = instance->situation->time;
  time_events_values(&settlement, present);
  size_t branch = first_to_turn(&settlement);
  if (branch == settlement.switches->branch_count) return false;
  const struct SampleFacts *sample = sample_of(settlement.switches, branch);
  *time = sample != NULL ? sample_time(instance, sample) : present;
  for (int i = 0; i < ZERO_STEPS && sample == NULL; i++) {
    *time += time_to_zero(&settlement, branch);
    time_events_values(&settlement, *time);
  }
  *time = fmax(*time, present);
  return isfinite(*time);
}

static bool is_due(struct Instance *instance) {
  struct Settlement settlement = settlement_of(instance);
  double present = instance->situation->time;
  time_events_values(&settlement, present);
  size_t branch = first_to_turn(&settlement);
  return branch < settlement.switches->branch_count && time_to_zero(&settlement, branch) <= rounding_of_time(present);
}

const struct TimeLaws time_laws = {.next = find_next_time, .is_due = is_due, .start = samples_start};
