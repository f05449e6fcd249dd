#include "nonsmooth/planes/plane_stops.h"

#include <math.h>

#include "nonsmooth/planes/rest_forces.h"

/* In units of the change until the slip would end: velocities that change by more do not stop with a slow friction. */
static const double passing_change = 10.0;

/* In units of the slow speeds, each relative to its scale: the same for velocities of a motion in which points are slow. */
static const double singular_change = 100.0;

/*
 * Returns the longest time in which a slow friction would stop at its present rate, and the largest speed relative to its
 * scale. Lets all at rest stick.
 */
static double time_to_stop(struct Resolution *resolution, double *speed) {
  double longest = 0.0;
  for (size_t i = 0; i < resolution->switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    if (*part_of_plane(resolution, &state) == LEFT_OUT || state.mode == PLANE_STICKS) continue;
    if (state.speed > 0.0) longest = fmax(longest, state.speed / hypot(state.rate[0], state.rate[1]));
    *speed = fmax(*speed, state.speed / resolution->value[plane_slot(resolution->switches, i)]);
    plane_stick(resolution, &state);
  }
  return longest;
}

bool plane_stops_motion(struct Resolution *resolution, bool *stops) {
  const double *nominal = lagrangian.steps.nominal + lagrangian.coordinate_count;
  double most = 0.0, change = 0.0, speed = 0.0;
  resolution_keep_modes(resolution);
  double duration = resolution->occasion != AT_START ? time_to_stop(resolution, &speed) : 0.0;
  bool is_determined = !(duration > 0.0) || resolution_find_correction(resolution);
  resolution_restore_modes(resolution);
  for (size_t i = 0; i < lagrangian.coordinate_count && duration > 0.0 && is_determined; i++) {
    most = fmax(most, duration * fabs(resolution->acceleration[i]) / nominal[i]);
    change = fmax(change, fabs(resolution->correction[i]) / nominal[i]);
  }
  *stops =
      change <= fmax(fmin(passing_change * most, singular_change * speed), resolution->instance->fmu_state->tolerance);
  return is_determined;
}
