#include "instance/event_laws.h"

#include <string.h>

#include "evaluation/services.h"
#include "nonsmooth/branches.h"
#include "events/exchange.h"
#include "events/passing.h"
#include "nonsmooth/resolution.h"

static bool holds_at_times(const char *constraint) {
  const struct SwitchTable *switches = lagrangian.switches;
  bool is_switched = false;
  for (size_t i = 0; i < switches->contact_count; i++)
    is_switched |= strcmp(switches->contacts[i].name, constraint) == 0;
  for (size_t i = 0; i < switches->friction_count; i++)
    is_switched |= strcmp(switches->frictions[i].name, constraint) == 0;
  return is_switched;
}

/* Distance of a ball's centre from the other shape at which a solver stops, relative to the radii. */
static const double nearest_centre = 1e-5;

static bool explain_ball(struct Instance *instance, enum Status status, double time) {
  const struct SwitchTable *switches = lagrangian.switches;
  if (switches->ball_count == 0) return false;
  struct Resolution resolution = resolution_of(instance);
  struct Point point = solver_point(instance, time, instance->state);
  switches->ball_distances(&point, resolution.acceleration, resolution.ball_distance);
  size_t ball = 0;
  while (ball < switches->ball_count && !(resolution.ball_distance[ball] <= nearest_centre)) ball++;
  if (ball == switches->ball_count) return false;
  log_message(
      instance, status,
      "time %g: at the contact '%s' the centre of a ball has come into the other shape, or two axes have met, so "
      "that its force has no direction; expected a larger stiffness, or a slower impact",
      time, switches->ball_names[ball]);
  return true;
}

const struct EventLaws event_laws = {.work_count = resolution_work_count,
                                     .resolve = exchange_resolve,
                                     .guess = branches_guess,
                                     .start = events_start,
                                     .part = events_part,
                                     .resolve_change = events_resolve_change,
                                     .update = events_update,
                                     .pass = events_pass,
                                     .pass_barrier = events_pass_barrier,
                                     .step_over = events_step_over,
                                     .explain = events_explain,
                                     .explain_stop = events_explain_stop,
                                     .explain_ball = explain_ball,
                                     .holds_at_times = holds_at_times,
                                     .check = events_check,
                                     .change_pieces = exchange_change_pieces,
                                     .return_pieces = exchange_return_pieces,
                                     .indicators = exchange_indicators,
                                     .is_due = exchange_is_due};
