/*
 * Slip directions at the onset of slip. A friction at its limit S slides from rest along the unit vector d for which
 * its acceleration a(d), with the friction force -S d, is a nonnegative multiple of d. With the mobility K of its
 * velocity, a(d) = b - S K d; for a symmetric positive definite K there is one d if |K^-1 b| >= S, else it sticks. The
 * acceleration across d is a function of the angle of d. Where it changes from left to right, the angle is bracketed in
 * one of SECTORS sectors, the nearest to the last direction first. It is located by false position with halved weights
 * (a variant of the Illinois method) and a bisection every third step. The directions of several frictions are found
 * one after another, in nonlinear Gauss-Seidel sweeps, until none rotates; after TURN_LIMIT sweeps the search fails.
 * Each angle needs an evaluation of the accelerations.
 */
#include "planes/plane_starts.h"

#include <math.h>

#include "contacts/frictions.h"

/* Sweeps over all frictions; sectors of the circle; steps within a sector. */
enum { TURN_LIMIT = 200, SECTORS = 64, HEADING_STEPS = 200 };

/* Rounding error of an acceleration, relative to its change by friction. */
static const double rounding_share = 1e-11;
/* In rad: directions that differ by less are equal; the width to which a direction is located. */
static const double same_heading = 1e-9, least_sector = 1e-15;

/* The search for the slip direction of one friction. */
struct Heading {
  struct Resolution *resolution;
  size_t plane;
  bool is_known;             /* false once accelerations did not exist */
  double ahead, error_bound; /* acceleration along the direction that was tried last; its rounding error */
};

/* Returns the acceleration across a direction, positive to the left: the velocity turns that way. */
static double turn_at(struct Heading *heading, double angle) {
  struct Resolution *resolution = heading->resolution;
  const struct PlaneMetadata *metadata = &resolution->switches->planes[heading->plane];
  double c = cos(angle), s = sin(angle);
  resolution_set_mode(resolution, metadata->heading[0], c);
  resolution_set_mode(resolution, metadata->heading[1], s);
  heading->is_known = heading->is_known && plane_evaluate(resolution);
  struct PlaneState state = plane_state(resolution, heading->plane);
  heading->ahead = c * state.rate[0] + s * state.rate[1];
  return c * state.rate[1] - s * state.rate[0];
}

/* Returns the direction without acceleration across, between one with it to the left and a further one to the right. */
static double refine_heading(struct Heading *heading, double from, double turn, double to, double turn_behind) {
  double weight = 1.0, weight_behind = 1.0;
  for (int i = 0; i < HEADING_STEPS && to - from > least_sector; i++) {
    double first = weight * turn, last = weight_behind * turn_behind, middle = 0.5 * (from + to);
    double angle = i % 3 == 2 ? middle : from + (to - from) * (first / (first - last));
    if (!(angle > from && angle < to)) angle = middle;
    if (!(angle > from && angle < to)) break;
    double next = turn_at(heading, angle);
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
static bool leaves_between(struct Heading *heading, double from, double turn, double to, double turn_behind,
                           double *found) {
  if (!(turn > 0.0 && turn_behind <= 0.0)) return false;
  *found = refine_heading(heading, from, turn, to, turn_behind);
  turn_at(heading, *found);
  return heading->ahead >= -heading->error_bound;
}

/*
 * Measures the effect of friction: a reversal of its direction changes the acceleration by twice its effect, which is 0
 * if constraints hold the velocity.
 */
static void measure_friction(struct Heading *heading, double angle) {
  const double half_turn = acos(-1.0);
  heading->error_bound = 0.0;
  for (int i = 0; i < 2; i++, angle += 0.5 * half_turn) {
    double turn = turn_at(heading, angle), ahead = heading->ahead, back = turn_at(heading, angle + half_turn);
    heading->error_bound = fmax(heading->error_bound, rounding_share * hypot(turn + back, ahead + heading->ahead));
  }
}

/* Returns the direction nearest to the first one along which it accelerates; NAN for none. */
static double nearest_heading(struct Heading *heading, double first) {
  measure_friction(heading, first);
  double sector = 2.0 * acos(-1.0) / SECTORS, turn = turn_at(heading, first), left = turn, right = turn, found = NAN;
  if (fabs(turn) <= heading->error_bound) return heading->ahead >= -heading->error_bound ? first : NAN;
  for (int i = 0; i < SECTORS / 2; i++) {
    double near = i * sector, far = near + sector;
    double next = turn_at(heading, first + far);
    if (leaves_between(heading, first + near, left, first + far, next, &found)) return found;
    left = next;
    next = turn_at(heading, first - far);
    if (leaves_between(heading, first - far, next, first - near, right, &found)) return found;
    right = next;
  }
  return NAN;
}

/* True if the friction needs a slip direction. If other constraints hold its velocity, it keeps its direction. */
static bool turns(struct Resolution *resolution, const struct PlaneState *state) {
  bool is_constrained = false;
  if (state->mode != PLANE_HEADS || state->is_given || state->speed > state->upper) return false;
  return !frictions_find_constrained(resolution, state->metadata->along, &is_constrained) || !is_constrained;
}

/*
 * Makes a sweep over all frictions. *largest: largest rotation, in rad; *stays as in plane_headings_find(). False if
 * accelerations do not exist.
 */
static bool turn_all(struct Resolution *resolution, double *largest, size_t *stays) {
  const struct SwitchTable *switches = resolution->switches;
  *largest = 0.0;
  for (size_t i = 0; i < switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    if (!turns(resolution, &state)) continue;
    struct Heading heading = {.resolution = resolution, .plane = i, .is_known = true};
    double c = mode_of(resolution, state.metadata->heading[0]), s = mode_of(resolution, state.metadata->heading[1]);
    double first = atan2(s, c), found = nearest_heading(&heading, first);
    if (!heading.is_known) return false;
    if (isnan(found)) {
      *stays = i;
      return true;
    }
    *largest = fmax(*largest, fabs(found - first));
    turn_at(&heading, found);
  }
  return true;
}

bool plane_headings_find(struct Resolution *resolution, bool *changed, size_t *stays) {
  double largest = INFINITY;
  bool was_changed = resolution->changed;
  *changed = false;
  *stays = resolution->switches->plane_count;
  for (int count = 0; count < TURN_LIMIT && largest > same_heading; count++) {
    if (!turn_all(resolution, &largest, stays)) return false;
    if (*stays < resolution->switches->plane_count) return true;
    *changed |= largest > same_heading;
  }
  resolution->changed = was_changed || *changed;
  return largest <= same_heading;
}
