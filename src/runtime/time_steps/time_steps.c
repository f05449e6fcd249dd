#include "time_steps/time_steps.h"

#include <math.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "evaluation/services.h"
#include "instance/active_constraints.h"
#include "instance/time_laws.h"
#include "nonsmooth/resolution.h"
#include "nonsmooth/resolve.h"
#include "time_steps/time_step.h"

/* The first step, relative to the longest one, and the factor of each further one. */
static const double first_share = 1.0 / 64.0, growth = 2.0;

/* Divisor of a step without impulses, and the shortest one that is tried. */
static const double shortening = 4.0, shortest_share = 1e-4;

/* Steps after which the modes must agree; each costs about as much as an event. */
enum { TIME_STEP_LIMIT = 10000 };

/* True if the modes of a copy of the state agree with it. The copy, with its jumps, is then taken; else the modes stay. */
static bool modes_agree(struct Instance *instance, double time, double *state) {
  size_t size = lagrangian.state_count * sizeof *state;
  double *copy = state + lagrangian.state_count;
  bool switches;
  memcpy(copy, state, size);
  bool agree = resolve_or_restore(instance, time, copy, &switches);
  if (agree) memcpy(state, copy, size);
  return agree;
}

/* True if the state can be moved onto the constraints of the present modes. */
static bool is_on_constraints(struct Instance *instance, double time) {
  return evaluate_prepare(instance) == STATUS_DONE && solver_project(instance, time, instance->event_state) == NULL;
}

/* Takes the modes of the last step where none agree with the state; else opens all contacts. False if that fails. */
static bool take_provisional_modes(struct Instance *instance, double time) {
  if (is_on_constraints(instance, time)) return true;
  struct Resolution resolution = resolution_at(instance, time, instance->event_state, AT_CHANGE);
  release_contacts(&resolution);
  return is_on_constraints(instance, time);
}

/* Takes a time step, or a shorter one if that has no impulses. Returns its length; 0 if none has. */
static double take_time_step(struct Instance *instance, double time, double limit, double *share, double *longest) {
  *share = fmin(fmax(growth * *share, first_share), 1.0);
  for (; *share >= shortest_share; *share /= shortening) {
    struct Resolution resolution = resolution_at(instance, time, instance->event_state, AT_CHANGE);
    double length = time_step(&resolution, *share, limit, longest);
    if (length > 0.0) return length;
  }
  return 0.0;
}

bool step_over_events(struct Instance *instance, double until, double end, double *share, double *time,
                      double *longest) {
  const struct SwitchTable *switches = lagrangian.switches;
  bool has_events = switches->event_count > switches->sample_count;
  if (has_events || instance->stops_at_events) return false;
  if (switches->time_laws != NULL) end = fmin(end, next_sample(instance, *time));
  for (int i = 0; i < TIME_STEP_LIMIT && *time < end; i++) {
    double length = take_time_step(instance, *time, end - *time, share, longest);
    if (!(length > 0.0)) return false;
    bool is_end = length >= end - *time;
    *time = is_end ? end : *time + length;
    if (!is_end && *time < until) continue;
    if (!modes_agree(instance, *time, instance->event_state) && !(is_end && take_provisional_modes(instance, *time)))
      continue;
    return true;
  }
  return false;
}
