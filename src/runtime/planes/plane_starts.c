/*
 * From rest, friction that has come to its stiction slides along the unit vector d for which the acceleration a(d) of its
 * velocity, with the friction against d, is a positive multiple of d. With the mobility K of the velocity by itself a is
 * b - S K d, and there is one d where K b/S is outside of the unit circle. The headings of several are found one after the other
 * until none changes.
 */
#include "planes/plane_starts.h"

#include <math.h>

#include "contacts/frictions.h"

enum { TURN_LIMIT = 200, SECTORS = 64, HEADING_STEPS = 200 };

/* What rounding may make of accelerations, in units of what friction makes of them. */
static const double rounding_share = 1e-11;
/* In rad: headings that differ by less are the same, and one is found as well as that. */
static const double same_heading = 1e-9, least_sector = 1e-15;

struct Heading {
  struct Settlement *settlement;
  size_t plane;
  bool is_known;       /* all accelerations were there */
  double ahead, noise; /* the acceleration along the heading that was tried last, and what rounding may make of it */
};

/* The acceleration across a heading, to the left: it turns that way. */
static double turn_at(struct Heading *heading, double angle) {
  struct Settlement *settlement = heading->settlement;
  const struct PlaneFacts *facts = &settlement->switches->planes[heading->plane];
  double c = cos(angle), s = sin(angle);
  settlement_set_mode(settlement, facts->heading[0], c);
  settlement_set_mode(settlement, facts->heading[1], s);
  heading->is_known = heading->is_known && plane_evaluate(settlement);
  struct PlaneState state = plane_state(settlement, heading->plane);
  heading->ahead = c * state.rate[0] + s * state.rate[1];
  return c * state.rate[1] - s * state.rate[0];
}

/* Where it turns neither way, between one at which it turns to the left and a further one at which to the right. */
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

/* Whether it slides away along a heading between two; *found is this one. */
static bool leaves_between(struct Heading *heading, double from, double turn, double to, double turn_behind,
                           double *found) {
  if (!(turn > 0.0 && turn_behind <= 0.0)) return false;
  *found = refine_heading(heading, from, turn, to, turn_behind);
  turn_at(heading, *found);
  return heading->ahead >= -heading->noise;
}

/* Friction the other way round changes the acceleration by as much as all that it makes, twice; along what others hold, by nothing. */
static void measure_friction(struct Heading *heading, double angle) {
  const double half_turn = acos(-1.0);
  heading->noise = 0.0;
  for (int i = 0; i < 2; i++, angle += 0.5 * half_turn) {
    double turn = turn_at(heading, angle), ahead = heading->ahead, back = turn_at(heading, angle + half_turn);
    heading->noise = fmax(heading->noise, rounding_share * hypot(turn + back, ahead + heading->ahead));
  }
}

/* The nearest heading to a first one along which it slides away; NAN for none. */
static double nearest_heading(struct Heading *heading, double first) {
  measure_friction(heading, first);
  double sector = 2.0 * acos(-1.0) / SECTORS, turn = turn_at(heading, first), left = turn, right = turn, found = NAN;
  if (fabs(turn) <= heading->noise) return heading->ahead >= -heading->noise ? first : NAN;
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

/* One whose velocity others hold pushes along the heading that it has. */
static bool turns(struct Settlement *settlement, const struct PlaneState *state) {
  bool is_held = false;
  if (state->mode != PLANE_HEADS || state->is_given || state->speed > state->upper) return false;
  return !frictions_find_held(settlement, state->facts->along, &is_held) || !is_held;
}

/* One sweep over all: the largest turn of any, in rad; *stays as above. False where there are no accelerations. */
static bool turn_all(struct Settlement *settlement, double *largest, size_t *stays) {
  const struct SwitchTable *switches = settlement->switches;
  *largest = 0.0;
  for (size_t i = 0; i < switches->plane_count; i++) {
    struct PlaneState state = plane_state(settlement, i);
    if (!turns(settlement, &state)) continue;
    struct Heading heading = {.settlement = settlement, .plane = i, .is_known = true};
    double c = mode_of(settlement, state.facts->heading[0]), s = mode_of(settlement, state.facts->heading[1]);
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

bool plane_headings_find(struct Settlement *settlement, bool *changed, size_t *stays) {
  double largest = INFINITY;
  bool was_changed = settlement->changed;
  *changed = false;
  *stays = settlement->switches->plane_count;
  for (int count = 0; count < TURN_LIMIT && largest > same_heading; count++) {
    if (!turn_all(settlement, &largest, stays)) return false;
    if (*stays < settlement->switches->plane_count) return true;
    *changed |= largest > same_heading;
  }
  settlement->changed = was_changed || *changed;
  return largest <= same_heading;
}
