/*
 * Slip directions at the onset of slip. A friction at its limit S slides from rest along the unit vector d for which
 * its acceleration a(d), with the friction force -S d, is a nonnegative multiple of d. With the Delassus matrix W of
 * its velocity, a(d) = b - S W d; for a symmetric positive definite W there is one d if |W^-1 b| >= S, else it sticks.
 * The acceleration across d is a function of the angle of d. Where it changes from left to right, the angle is
 * bracketed in one of SECTORS sectors, the nearest to the last direction first. It is located by false position with
 * halved weights (a variant of the Illinois method) and a bisection every third step. The directions of several
 * frictions are found one after another, in nonlinear Gauss-Seidel sweeps, until none rotates; after SWEEP_LIMIT sweeps
 * the search fails. Each angle needs an evaluation of the accelerations.
 */
#include "planes/plane_starts.h"

#include <math.h>

#include "contacts/frictions.h"

/* Sweeps over all frictions; sectors of the circle; steps within a sector. */
enum { SWEEP_LIMIT = 200, SECTORS = 64, DIRECTION_STEPS = 200 };

/* Rounding error of an acceleration, relative to its change by friction. */
static const double rounding_share = 1e-11;
/* In rad: directions that differ by less are equal; the width to which a direction is located. */
static const double same_direction = 1e-9, least_sector = 1e-15;

/* The search for the slip direction of one friction. */
struct SlipSearch {
  struct Resolution *resolution;
  size_t plane;
  bool is_known;             /* false once accelerations did not exist */
  double ahead, error_bound; /* acceleration along the direction that was tried last; its rounding error */
};

/* Returns the acceleration across a direction, positive to the left: the velocity turns that way. */
static double acceleration_across(struct SlipSearch *slip_direction, double angle) {
  struct Resolution *resolution = slip_direction->resolution;
  const struct PlaneMetadata *metadata = &resolution->switches->planes[slip_direction->plane];
  double c = cos(angle), s = sin(angle);
  resolution_set_mode(resolution, metadata->slip_direction[0], c);
  resolution_set_mode(resolution, metadata->slip_direction[1], s);
  slip_direction->is_known = slip_direction->is_known && plane_evaluate(resolution);
  struct PlaneState state = plane_state(resolution, slip_direction->plane);
  slip_direction->ahead = c * state.rate[0] + s * state.rate[1];
  return c * state.rate[1] - s * state.rate[0];
}

/* Returns the direction without acceleration across, between one with it to the left and a further one to the right. */
static double refine_direction(struct SlipSearch *slip_direction, double from, double turn, double to,
                               double turn_behind) {
  double weight = 1.0, weight_behind = 1.0;
  for (int i = 0; i < DIRECTION_STEPS && to - from > least_sector; i++) {
    double first = weight * turn, last = weight_behind * turn_behind, middle = 0.5 * (from + to);
    double angle = i % 3 == 2 ? middle : from + (to - from) * (first / (first - last));
    if (!(angle > from && angle < to)) angle = middle;
    if (!(angle > from && angle < to)) break;
    double next = acceleration_across(slip_direction, angle);
    bool is_behind = next <= 0.0;
    weight = is_behind ? 0.5 * weight : 1.0;
    weight_behind = is_behind ? 1.0 : 0.5 * weight_behind;
    if (is_behind) {
      to = angle;
      turn_behind = next;
    } else {
      from = angle;
      turn = next;
    }
  }
  return turn < -turn_behind ? from : to;
}

/* True if it accelerates along a direction between two; *found is this one. */
static bool leaves_between(struct SlipSearch *slip_direction, double from, double turn, double to, double turn_behind,
                           double *found) {
  if (!(turn > 0.0 && turn_behind <= 0.0)) return false;
  *found = refine_direction(slip_direction, from, turn, to, turn_behind);
  acceleration_across(slip_direction, *found);
  return slip_direction->ahead >= -slip_direction->error_bound;
}

/*
 * Measures the effect of friction: a reversal of its direction changes the acceleration by twice its effect, which is 0
 * if constraints hold the velocity.
 */
static void measure_friction(struct SlipSearch *slip_direction, double angle) {
  const double half_turn = acos(-1.0);
  slip_direction->error_bound = 0.0;
  for (int i = 0; i < 2; i++, angle += 0.5 * half_turn) {
    double turn = acceleration_across(slip_direction, angle), ahead = slip_direction->ahead,
           back = acceleration_across(slip_direction, angle + half_turn);
    slip_direction->error_bound =
        fmax(slip_direction->error_bound, rounding_share * hypot(turn + back, ahead + slip_direction->ahead));
  }
}

/* Returns the direction nearest to the first one along which it accelerates; NAN for none. */
static double nearest_direction(struct SlipSearch *slip_direction, double first) {
  measure_friction(slip_direction, first);
  double sector = 2.0 * acos(-1.0) / SECTORS, turn = acceleration_across(slip_direction, first), left = turn,
         right = turn, found = NAN;
  if (fabs(turn) <= slip_direction->error_bound)
    return slip_direction->ahead >= -slip_direction->error_bound ? first : NAN;
  for (int i = 0; i < SECTORS / 2; i++) {
    double near = i * sector, far = near + sector;
    double next = acceleration_across(slip_direction, first + far);
    if (leaves_between(slip_direction, first + near, left, first + far, next, &found)) return found;
    left = next;
    next = acceleration_across(slip_direction, first - far);
    if (leaves_between(slip_direction, first - far, next, first - near, right, &found)) return found;
    right = next;
  }
  return NAN;
}

/* True if the friction needs a slip direction. If other constraints hold its velocity, it keeps its direction. */
static bool turns(struct Resolution *resolution, const struct PlaneState *state) {
  bool is_constrained = false;
  if (state->mode != PLANE_SLIPS || state->is_given || state->speed > state->upper) return false;
  return !frictions_find_constrained(resolution, state->metadata->along, &is_constrained) || !is_constrained;
}

/*
 * Makes a sweep over all frictions. *largest: largest rotation, in rad; *stays as in plane_slip_directions_find().
 * False if accelerations do not exist.
 */
static bool rotate_all(struct Resolution *resolution, double *largest, size_t *stays) {
  const struct SwitchTable *switches = resolution->switches;
  *largest = 0.0;
  for (size_t i = 0; i < switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    if (!turns(resolution, &state)) continue;
    struct SlipSearch slip_direction = {.resolution = resolution, .plane = i, .is_known = true};
    double c = mode_of(resolution, state.metadata->slip_direction[0]),
           s = mode_of(resolution, state.metadata->slip_direction[1]);
    double first = atan2(s, c), found = nearest_direction(&slip_direction, first);
    if (!slip_direction.is_known) return false;
    if (isnan(found)) {
      *stays = i;
      return true;
    }
    *largest = fmax(*largest, fabs(found - first));
    acceleration_across(&slip_direction, found);
  }
  return true;
}

bool plane_slip_directions_find(struct Resolution *resolution, bool *changed, size_t *stays) {
  double largest = INFINITY;
  bool was_changed = resolution->changed;
  *changed = false;
  *stays = resolution->switches->plane_count;
  for (int count = 0; count < SWEEP_LIMIT && largest > same_direction; count++) {
    if (!rotate_all(resolution, &largest, stays)) return false;
    if (*stays < resolution->switches->plane_count) return true;
    *changed |= largest > same_direction;
  }
  resolution->changed = was_changed || *changed;
  return largest <= same_direction;
}
