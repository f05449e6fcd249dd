/*
 * Contacts: impacts, rest and parting. act_once() makes one change a round. It opens contacts that were lifted or part,
 * else takes impacts (impact_sequence.c), else closes contacts that come to rest. Otherwise it projects out
 * penetrations. open_pulling() opens the closed contact that pulls most. resolve.c repeats the rounds until none changes
 * anything.
 *
 * A contact that its force or an event has opened cannot come to rest by itself in the event, until an impact. The same
 * holds for one that contact_forces.c has closed (enum Forced).
 */
#include <math.h>

#include "nonsmooth/contacts/contact_forces.h"
#include "nonsmooth/contacts/impact_sequence.h"
#include "nonsmooth/contacts/load_shares.h"
#include "nonsmooth/contacts/planes.h"
#include "nonsmooth/contacts/contact_impulses.h"
#include "nonsmooth/tolerances.h"
#include "evaluation/evaluate.h"
#include "nonsmooth/continuity.h"
#include "detection/indicators.h"
#include "nonsmooth/resolution.h"

/* Projections of penetrated contacts, in an event and at the start. */
enum { LIFT_LIMIT = 20 };

/*
 * A negative gap of at most this number of rounding error bounds is not located again, since the search allows
 * FLOOR_IN_ERROR_BOUND.
 */
static const double found_again = 0.25 * FLOOR_IN_ERROR_BOUND;

/* Forces below this share of the largest one are rounding errors, where a body begins to tip over an edge. */
static const double vanishing_share = 1e-13;

static const char penetrated[] = "a contact is penetrated";

/*
 * True if the bounce is lower than the error of the importer's first step after the impact. The importer would then
 * find the contact penetrated while it still opens, after this impact and each following one.
 */
static bool is_overtaken(const struct Resolution *resolution, size_t contact) {
  size_t gap = contact_slot(resolution->switches, contact, CONTACT_GAP);
  const double *value = &resolution->value[gap], *error_bound = &resolution->error_bound[gap];
  bool has_jumped = resolution->jumped || resolution->moved || resolution->switched != NULL || resolution->set_mode;
  if (resolution->occasion != IN_EXCHANGE || has_jumped || !(value[CONTACT_GAP] < -error_bound[CONTACT_GAP]))
    return false;
  double height = 0.5 * value[CONTACT_RATE] * value[CONTACT_RATE] / -value[CONTACT_ACCELERATION];
  return value[CONTACT_RATE] > error_bound[CONTACT_RATE] && height <= resolution->tolerances.rounded;
}

/*
 * True if a gap that was located to fall has neither rate nor acceleration: higher derivatives close it. An example is
 * the gap of a body that begins to slip towards an open contact, where its friction reaches the limit.
 */
static bool sinks_without_acceleration(const struct Resolution *resolution, size_t contact) {
  size_t gap = contact_slot(resolution->switches, contact, CONTACT_GAP);
  const double *value = &resolution->value[gap], *error_bound = &resolution->error_bound[gap];
  return is_hit(resolution, contact_indicator(resolution->switches, contact)) &&
         fabs(value[CONTACT_RATE]) <= error_bound[CONTACT_RATE] &&
         fabs(value[CONTACT_ACCELERATION]) <= error_bound[CONTACT_ACCELERATION];
}

/* True if the projection of other contacts that came to rest left the contact closing, too slowly for an impact. */
static bool closes_by_projection(const struct Resolution *resolution, size_t contact) {
  size_t rate = contact_slot(resolution->switches, contact, CONTACT_RATE);
  return resolution->lost_speed > 0.0 && resolution->value[rate] < -resolution->error_bound[rate];
}

/* True if an open contact touches, and would sink, or only make bounces that errors hide. */
static bool comes_to_rest(const struct Resolution *resolution, size_t contact) {
  size_t acceleration = contact_slot(resolution->switches, contact, CONTACT_ACCELERATION);
  if (resolution->forced[contact] != UNFORCED || !is_touching(resolution, contact)) return false;
  if (sinks_without_acceleration(resolution, contact) || closes_by_projection(resolution, contact)) return true;
  if (!(-resolution->value[acceleration] > resolution->error_bound[acceleration])) return false;
  return is_overtaken(resolution, contact) ||
         bounce_is_lost(resolution, contact, contact_value(resolution, contact, CONTACT_RATE));
}

/* Lets sticking frictions slide if an impact has given them a velocity, before the velocities are projected. */
static void let_moving_slide(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->friction_count && resolution->jumped; i++) {
    size_t slot = friction_slot(switches, i, FRICTION_VELOCITY);
    double velocity = resolution->value[slot];
    if (!friction_sticks(resolution, i) ||
        fabs(velocity) <= resolution_error_bound(resolution, slot, slot + FRICTION_RATE))
      continue;
    set_friction(resolution, i, velocity < 0.0 ? -1.0 : 1.0);
  }
}

/* Lets a friction of the contact stick if it does not slide. */
static void stick_if_stopped(struct Resolution *resolution, size_t contact, size_t friction) {
  size_t velocity = friction_slot(resolution->switches, friction, FRICTION_VELOCITY);
  bool slides = sliding_speed(resolution, friction) > resolution->error_bound[velocity];
  if (rests_on(resolution->switches, friction, contact) && !slides) set_friction(resolution, friction, 0.0);
}

/* Lets frictions stick that do not slide as the contact comes to rest: the projection of the gap would move them. */
static void let_stick(struct Resolution *resolution, size_t contact) {
  for (size_t i = 0; i < resolution->switches->friction_count; i++) stick_if_stopped(resolution, contact, i);
}

/* Lets frictions along lines stick that the projection of the velocities has stopped. False if values do not exist. */
static bool let_stopped_stick(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  if (switches->friction_count == 2 * switches->plane_count) return true; /* each plane has two, and no line has one */
  if (!evaluate_velocities(resolution)) return false;
  for (size_t i = 0; i < switches->friction_count; i++) {
    if (plane_of(switches, i) < switches->plane_count) continue;
    for (size_t j = 0; j < switches->contact_count; j++)
      if (contact_is_closed(resolution, j)) stick_if_stopped(resolution, j, i);
  }
  return true;
}

/*
 * True if a touching contact stays with others that come to rest. Rates of a body that comes to lie flat differ by
 * rounding errors. The last contact does not accelerate by itself, but shares the load. enum Forced is ignored: a
 * contact that pulled before the others came to rest may rest too.
 */
static bool rests_with_others(const struct Resolution *resolution, size_t contact) {
  size_t acceleration = contact_slot(resolution->switches, contact, CONTACT_ACCELERATION);
  if (!is_touching(resolution, contact)) return false;
  if (resolution->value[acceleration] > resolution->error_bound[acceleration]) return false;
  return bounce_is_lost(resolution, contact, 0.5 * contact_value(resolution, contact, CONTACT_RATE));
}

static bool close_those(struct Resolution *resolution, bool (*rests)(const struct Resolution *, size_t)) {
  bool closes = false;
  for (size_t i = 0; i < resolution->switches->contact_count; i++) {
    if (contact_is_closed(resolution, i) || !rests(resolution, i)) continue;
    double speed = fabs(contact_value(resolution, i, CONTACT_RATE));
    resolution->lost_speed = fmax(resolution->lost_speed, speed);
    set_contact(resolution, i, true);
    let_stick(resolution, i);
    closes = true;
  }
  return closes;
}

/* Closes all contacts that come to rest, and, in this round and the next, those that stay with them. True if any. */
static bool close_contacts(struct Resolution *resolution) {
  bool comes = close_those(resolution, comes_to_rest), shares = comes || resolution->came_to_rest;
  resolution->came_to_rest = comes;
  if (!(shares && close_those(resolution, rests_with_others)) && !comes) return false;
  let_moving_slide(resolution);
  return true;
}

static const char *report_rest(const struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  size_t contact = 0;
  while (contact + 1 < switches->contact_count && !is_touching(resolution, contact)) contact++;
  log_message(resolution->instance, resolution_status(resolution),
              "time %g: no velocities are found with which the contact '%s' can close; expected another position, or "
              "fewer constraints",
              resolution->time, switches->contacts[contact].name);
  return impact_without_solution;
}

/*
 * Returns a closed contact that accelerates towards closing although no force changes its gap; contact_count for none.
 */
static size_t find_prescribed(const struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  size_t contact = 0;
  while (contact < switches->contact_count &&
         (!contact_is_closed(resolution, contact) ||
          resolution_moves(resolution, switches->contacts[contact].constraint) ||
          contact_value(resolution, contact, CONTACT_ACCELERATION) >=
              -resolution->error_bound[contact_slot(switches, contact, CONTACT_ACCELERATION)]))
    contact++;
  return contact;
}

/* Projects the velocities onto the contacts that have come to rest. NULL, or the reason why that fails. */
static const char *let_rest(struct Resolution *resolution) {
  if (!resolution_project_velocities(resolution)) return report_rest(resolution);
  size_t fixed = find_prescribed(resolution);
  if (fixed < resolution->switches->contact_count) {
    contact_forces_report_fixed(resolution, fixed);
    return impact_without_solution;
  }
  return let_stopped_slip(resolution) && let_stopped_stick(resolution) ? NULL : report_rest(resolution);
}

/* Opens closed contacts that were moved apart. True if any. */
static bool open_lifted(struct Resolution *resolution) {
  double drift = resolution->tolerances.drift;
  bool opens = false;
  for (size_t i = 0; i < resolution->switches->contact_count; i++) {
    if (!contact_is_closed(resolution, i) || contact_value(resolution, i, CONTACT_GAP) <= drift) continue;
    set_contact(resolution, i, false);
    opens = true;
  }
  return opens;
}

/* Opens closed contacts whose gap opens faster than errors, at a switch such as an edge or by an event. True if any. */
static bool open_parting(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  double kink = resolution->tolerances.kink;
  bool opens = false;
  for (size_t i = 0; i < switches->contact_count; i++) {
    size_t slot = contact_slot(switches, i, CONTACT_RATE);
    double rate = resolution->value[slot], least = resolution->thrown ? resolution->error_bound[slot] : kink;
    if (!contact_is_closed(resolution, i) || !(rate > least)) continue;
    set_contact(resolution, i, false);
    resolution->forced[i] = FORCED_OPEN;
    opens = true;
  }
  return opens;
}

static bool part(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  open_lifted(resolution);
  for (size_t i = 0; i < switches->contact_count; i++) {
    double gap = contact_value(resolution, i, CONTACT_GAP);
    if (contact_is_closed(resolution, i) || gap >= -resolution->tolerances.drift) continue;
    log_message(
        resolution->instance, STATUS_DISCARD,
        "time %g: after a parameter, an input or a state was set, the contact '%s' is penetrated: its gap is %g; "
        "expected values for which it is not negative",
        resolution->time, switches->contacts[i].name, gap);
    return false;
  }
  return true;
}

/*
 * True if the penetration of an open contact has to be projected out. An importer locates contacts late, and would
 * not see a zero of an indicator that stays negative. At an event this concerns a contact without speed. It also
 * concerns one that has just opened and that the projection onto other constraints has left penetrated. Its event
 * would be located again and again.
 */
static bool has_to_lift(const struct Resolution *resolution, size_t contact) {
  size_t gap = contact_slot(resolution->switches, contact, CONTACT_GAP), rate = gap + CONTACT_RATE;
  const double *value = resolution->value, *error_bound = resolution->error_bound;
  if (contact_is_closed(resolution, contact) || !(value[gap] < -error_bound[gap])) return false;
  if (!(value[gap] >= -resolution->tolerances.drift)) return false;
  bool has_stopped = resolution->jumped && value[rate] <= error_bound[rate];
  bool is_stuck = is_hit(resolution, contact_indicator(resolution->switches, contact)) && value[rate] >= 0.0;
  bool comes_again = (has_stopped || is_stuck) && value[gap] < -found_again * error_bound[gap];
  return resolution->occasion == IN_EXCHANGE || (resolution->occasion == AT_EVENT && comes_again);
}

/* Projects the penetrations of all such contacts to 0; *lifts if there are any. False if the projection fails. */
static bool lift(struct Resolution *resolution, bool *lifts) {
  *lifts = false;
  if (resolution->moved || resolution->lifts == LIFT_LIMIT) return true;
  resolution_keep_modes(resolution);
  for (size_t i = 0; i < resolution->switches->contact_count; i++) {
    if (!has_to_lift(resolution, i)) continue;
    set_contact(resolution, i, true);
    *lifts = true;
  }
  if (!*lifts) return true;
  resolution->lifts++;
  bool done = resolution_project_coordinates(resolution);
  resolution_restore_modes(resolution);
  return done;
}

/* Returns the fixed coordinate that the last projection at the start has moved most; coordinate_count for none. */
static size_t find_moved_fixed(const struct Resolution *resolution) {
  const bool *is_fixed = lagrangian.constraints.coordinate_is_fixed;
  size_t found = lagrangian.coordinate_count;
  double most = resolution->tolerances.penetration; /* here in units of its scale */
  for (size_t i = 0; i < lagrangian.coordinate_count && is_fixed != NULL; i++) {
    double move = fabs(resolution->correction[i]) / scale_of(resolution->state, i);
    if (!is_fixed[i] || !(move > most)) continue;
    most = move;
    found = i;
  }
  return found;
}

/* Undoes a projection at the start that has moved a fixed coordinate. True if it has. */
static bool undo_move_of_fixed(struct Resolution *resolution) {
  if (find_moved_fixed(resolution) == lagrangian.coordinate_count) return false;
  for (size_t i = 0; i < lagrangian.coordinate_count; i++) resolution->state[i] -= resolution->correction[i];
  return true;
}

/* True if the penetration of a contact may come from rounded start values. */
static bool is_rounded(const struct Resolution *resolution, size_t contact) {
  double gap = contact_value(resolution, contact, CONTACT_GAP);
  const struct Tolerances tolerances = resolution->tolerances;
  return gap < -tolerances.penetration && gap >= -tolerances.rounded;
}

/*
 * Projects out penetrations by rounded start values; start_gap keeps the most negative one of each contact. True if
 * there are any, and they can be moved.
 */
static bool part_at_start(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  bool parts = false;
  resolution_keep_modes(resolution);
  for (size_t i = 0; i < switches->contact_count; i++) {
    if (!is_rounded(resolution, i)) continue;
    resolution->start_gap[i] = fmin(resolution->start_gap[i], contact_value(resolution, i, CONTACT_GAP));
    set_contact(resolution, i, true);
    parts = true;
  }
  parts = parts && resolution_project_coordinates(resolution) && !undo_move_of_fixed(resolution);
  resolution_restore_modes(resolution);
  return parts;
}

static void log_parted(const struct Resolution *resolution) {
  for (size_t i = 0; i < resolution->switches->contact_count; i++)
    if (resolution->start_gap[i] < 0.0 && !is_rounded(resolution, i))
      log_message(resolution->instance, STATUS_DONE,
                  "time %g: the start values are moved to open the contact '%s', whose gap was %g", resolution->time,
                  resolution->switches->contacts[i].name, resolution->start_gap[i]);
}

static bool lift_start(struct Resolution *resolution) {
  int count = 0;
  while (count < LIFT_LIMIT && part_at_start(resolution)) {
    if (!resolution_evaluate(resolution)) return false;
    count++;
  }
  log_parted(resolution);
  return count == 0 || resolution_project_velocities(resolution);
}

/* Returns the force below which that of a contact has vanished with that of another one; 0 if none has opened. */
static double vanishing_force(const struct Resolution *resolution) {
  bool any_opened = false;
  for (size_t i = 0; i < resolution->switches->contact_count; i++) any_opened |= resolution->forced[i] == FORCED_OPEN;
  return any_opened ? vanishing_share * largest_contact_force(resolution) : 0.0;
}

/* True if the gap of a closed contact opens nevertheless: its constraint contradicts others, which move it apart. */
static bool is_torn_apart(const struct Resolution *resolution, size_t contact) {
  size_t slot = contact_slot(resolution->switches, contact, CONTACT_ACCELERATION);
  double acceleration = resolution->value[slot];
  return acceleration > resolution->error_bound[slot] &&
         acceleration > rounded_acceleration_of_gap(resolution, contact);
}

/*
 * True if the force of a closed contact has just reached 0, once an event. An importer stops at a zero or beyond it, and
 * does not say of which indicator.
 */
static bool has_reached_zero(const struct Resolution *resolution, size_t contact, double force) {
  bool is_reached = is_hit(resolution, contact_indicator(resolution->switches, contact)) ||
                    (resolution->occasion == IN_EXCHANGE && force <= 0.0);
  bool was_closed = first_mode_of(resolution, resolution->switches->contacts[contact].mode) > 0.0;
  return is_reached && was_closed && !resolution->jumped;
}

/*
 * Returns the closed contact that pulls most; else one that is torn apart, has no share of the load, or whose force has
 * vanished. contact_count for none.
 */
static size_t find_pulling(const struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  size_t found = switches->contact_count;
  double most = 0.0, vanishing = vanishing_force(resolution);
  double no_share = rounded_force * largest_contact_force(resolution);
  for (size_t i = 0; i < switches->contact_count; i++) {
    if (!contact_is_closed(resolution, i)) continue;
    double force = contact_force(resolution, i);
    bool vanishes = resolution->forced[i] == UNFORCED && (has_reached_zero(resolution, i, force) || force < vanishing);
    bool is_useless = resolution->forced[i] == SHARES_LOAD && !(force > no_share);
    if (!(force < 0.0) && !vanishes && !is_useless && !is_torn_apart(resolution, i)) continue;
    if (found < switches->contact_count && fmin(force, 0.0) >= most) continue;
    most = fmin(force, 0.0);
    found = i;
  }
  return found;
}

/*
 * Logs a contact whose gap, or whose rate where it touches, is not finite. Returns NULL if there is none, else the
 * reason to stop.
 */
static const char *check_values(const struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->contact_count; i++) {
    bool has_gap = isfinite(contact_value(resolution, i, CONTACT_GAP));
    bool needs_rate = contact_is_closed(resolution, i) || is_touching(resolution, i);
    if (has_gap && (!needs_rate || isfinite(contact_value(resolution, i, CONTACT_RATE)))) continue;
    log_message(resolution->instance, resolution_status(resolution),
                "time %g: the gap of the contact '%s' has no finite %s, as where exp(x) overflows above x = 709; "
                "expected a gap that is finite",
                resolution->time, switches->contacts[i].name, has_gap ? "rate" : "value");
    return "a contact has no finite gap";
  }
  return NULL;
}

/* Logs a contact that is penetrated by less than a rounded start value, which is fixed. False for others. */
static bool report_fixed_start(const struct Resolution *resolution, size_t contact) {
  bool is_undone = resolution->occasion == AT_START && resolution->start_gap[contact] < 0.0;
  size_t fixed = is_undone ? find_moved_fixed(resolution) : lagrangian.coordinate_count;
  if (fixed == lagrangian.coordinate_count) return false;
  double start = resolution->state[fixed];
  log_message(resolution->instance, STATUS_ERROR,
              "time %g: the contact '%s' is penetrated at the start: its gap is %g, and the start of '%s' is fixed at "
              "%.12g; expected %.12g, or fixed=\"false\", with which it is moved by the gap",
              resolution->time, resolution->switches->contacts[contact].name,
              contact_value(resolution, contact, CONTACT_GAP), evaluate_name(VARIABLE_STATE, fixed), start,
              start + resolution->correction[fixed]);
  return true;
}

static const char *check_gaps(const struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  const char *problem = check_values(resolution);
  if (problem != NULL) return problem;
  bool starts = resolution->occasion == AT_START, moved = resolution->moved;
  const struct Tolerances tolerances = resolution->tolerances;
  double allowed = starts || moved ? tolerances.penetration : tolerances.drift;
  for (size_t i = 0; i < switches->contact_count; i++) {
    double gap = contact_value(resolution, i, CONTACT_GAP);
    if (gap >= -allowed) continue;
    if (report_fixed_start(resolution, i)) return penetrated;
    log_message(
        resolution->instance, starts ? STATUS_ERROR : STATUS_DISCARD,
        "time %g: the contact '%s' is penetrated at %s: its gap is %g; expected %s for which it is not negative",
        resolution->time, switches->contacts[i].name,
        starts  ? "the start"
        : moved ? "an event that sets coordinates"
                : "an event that switches the gap",
        gap,
        starts  ? "start values or parameters"
        : moved ? "values of <set>"
                : "conditions and modes");
    return penetrated;
  }
  return NULL;
}

static const char *act_once(struct Resolution *resolution, bool *again) {
  bool may_change = may_change_gaps(resolution) && resolution->occasion != AT_START;
  *again = true;
  const char *problem = check_values(resolution);
  if (problem != NULL) return problem;
  if ((resolution->moved || may_change || resolution->occasion == IN_EXCHANGE) && open_lifted(resolution)) return NULL;
  if (may_change && !resolution->jumped) problem = check_gaps(resolution);
  if (problem != NULL) return problem;
  if (((may_change && !resolution->jumped) || resolution->thrown) && open_parting(resolution)) return NULL;
  if (takes_impacts(resolution, &problem)) return problem;
  if (close_contacts(resolution)) return let_rest(resolution);
  bool lifts;
  if (!lift(resolution, &lifts)) return report_rest(resolution);
  *again = lifts;
  return NULL;
}

static bool open_pulling(struct Resolution *resolution) {
  size_t pulling = find_pulling(resolution);
  if (pulling == resolution->switches->contact_count) return false;
  resolution->forced[pulling] = FORCED_OPEN;
  set_contact(resolution, pulling, false);
  let_unpressed_slide(resolution);
  return true;
}

const struct ContactLaws contact_laws = {.act = act_once,
                                         .open_pulling = open_pulling,
                                         .resolve_forces = contact_forces_resolve,
                                         .share_load = contacts_share_load,
                                         .part = part,
                                         .lift_start = lift_start,
                                         .check_gaps = check_gaps};
