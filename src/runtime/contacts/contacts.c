/*
 * Contacts: impacts, rest and parting. An impact takes the touching contact that closes fastest, together with those as
 * fast within rounding; the other touching contacts are open. Contacts that close because of it have impacts of their
 * own after it, so that a row of touching bodies passes an impulse on (Newton's cradle). After IMPACT_LIMIT impacts of
 * an event all that touch are taken at once, without restitution. If a contact still closes then, bodies are crushed,
 * and the motion ends.
 *
 * act_once() makes one change a round: it opens contacts that were lifted or part, or takes an impact, or closes those
 * that come to rest, or projects out penetrations, or opens the closed contact that pulls most. settle.c repeats the
 * rounds until none changes anything.
 *
 * was_opened of a contact is 1 after its force or an event has opened it, -1 after contact_forces.c has closed it, and
 * 0 again after an impact. A contact with a value other than 0 cannot come to rest in this event by itself.
 */
#include <float.h>
#include <math.h>

#include "contacts/contact_forces.h"
#include "contacts/impacts.h"
#include "contacts/load_shares.h"
#include "contacts/planes.h"
#include "contacts/pushes.h"
#include "evaluation/evaluate.h"
#include "evaluation/services.h"
#include "events/continuity.h"
#include "events/indicators.h"
#include "events/settlement.h"

/*
 * IMPACT_LIMIT: impacts of an event that are taken one after another. LIFT_LIMIT: projections of penetrated contacts,
 * in an event and at the start.
 */
enum { IMPACT_LIMIT = 1000, LIFT_LIMIT = 20 };

/* Closing speeds with a smaller relative difference are equal, so that impacts of symmetric systems stay symmetric. */
static const double equal_share = 1e-9;
/*
 * Penetration that is accepted at the start and after an event sets coordinates, in units of the gap. Relative to its
 * scale, a fixed coordinate may be moved by as much.
 */
static const double largest_penetration = 1e-9;

/* Relative to the largest coordinate: start values with four digits penetrate a contact by no more. */
static const double rounded_start = 1e-4;

/* In rounding error bounds: a negative gap up to this is not located again, as the search allows FLOOR_IN_NOISE. */
static const double found_again = 0.25 * FLOOR_IN_NOISE;

/* Relative to the largest rate of the gap in this event: impulses by iteration may leave smaller closing rates. */
static const double unresolved_share = 1e-6;

/* Smaller speeds have no direction: their squares are next to the smallest numbers. */
static const double least_speed = 1e-150;

static const char no_impact[] = "an impact of a contact has no solution";

/*
 * Returns the touching contact that closes fastest; contact_count for none. Rates within rounding do not count, but for
 * the contact whose zero was located, before its first impact.
 */
static size_t find_impact(const struct Settlement *settlement) {
  size_t found = settlement->switches->contact_count;
  double fastest = 0.0;
  for (size_t i = 0; i < settlement->switches->contact_count; i++) {
    size_t rate = contact_place(settlement->switches, i, CONTACT_RATE);
    bool is_open = !contact_is_closed(settlement, i) && settlement->was_opened[i] == 0.0;
    bool is_hit_first =
        is_hit(settlement, contact_indicator(settlement->switches, i)) && is_open && settlement->impacts == 0;
    bool closes = settlement->value[rate] < (is_hit_first ? 0.0 : -settlement->noise[rate]);
    if (!closes || !is_touching(settlement, i) || settlement->value[rate] >= fastest) continue;
    fastest = settlement->value[rate];
    found = i;
  }
  return found;
}

/* True if a contact still closes after an impact of all that touch. */
static bool closes_clearly(const struct Settlement *settlement, size_t contact) {
  size_t rate = contact_place(settlement->switches, contact, CONTACT_RATE);
  return settlement->value[rate] < -unresolved_share * settlement->largest[rate];
}

static void open_all(struct Settlement *settlement) {
  for (size_t i = 0; i < settlement->switches->contact_count; i++) set_contact(settlement, i, false);
}

/* Logs a restitution outside of 0 to 1, and returns false. */
static bool check_restitution(const struct Settlement *settlement, size_t contact) {
  double restitution = contact_value(settlement, contact, CONTACT_RESTITUTION);
  if (restitution >= 0.0 && restitution <= 1.0) return true;
  log_message(settlement->instance, STATUS_DISCARD,
              "time %g: the restitution of the contact '%s' is %g; expected one from 0 to 1", settlement->time,
              settlement->switches->contacts[contact].name, restitution);
  return false;
}

/*
 * Selects the contacts that are hit as fast as one, within rounding, and all frictions; beyond IMPACT_LIMIT all
 * touching contacts. False after logging an invalid restitution.
 */
static bool choose_hit(struct Settlement *settlement, size_t contact) {
  const struct SwitchTable *switches = settlement->switches;
  size_t place = contact_place(switches, contact, CONTACT_RATE);
  double fastest = settlement->value[place], noise = settlement->noise[place];
  bool bounces = settlement->impacts < IMPACT_LIMIT, is_fine = true;
  for (size_t i = 0; i < switches->contact_count; i++) {
    size_t rate = contact_place(switches, i, CONTACT_RATE);
    double slower = settlement->value[rate] - fastest;
    bool is_tied = slower <= noise + settlement->noise[rate] - equal_share * fastest;
    settlement->takes_part[i] = is_touching(settlement, i) && (is_tied || !bounces) ? 1.0 : 0.0;
    if (settlement->takes_part[i] == 0.0) continue;
    is_fine &= check_restitution(settlement, i);
    settlement->was_opened[i] = 0.0;
  }
  for (size_t i = 0; i < switches->friction_count; i++) settlement->takes_part[switches->contact_count + i] = 1.0;
  return is_fine;
}

/* Lets sticking frictions slide whose contacts are all open. */
static void let_go(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  for (size_t i = 0; i < switches->friction_count; i++) {
    bool rests = false, presses = false;
    for (size_t k = 0; k < switches->contact_count; k++) {
      if (!rests_on(switches, i, k)) continue;
      rests = true;
      presses |= contact_is_closed(settlement, k);
    }
    if (!rests || presses || !friction_sticks(settlement, i)) continue;
    set_friction(settlement, i, 1.0);
  }
}

static void let_all_slide(struct Settlement *settlement) {
  for (size_t i = 0; i < settlement->switches->friction_count; i++) set_friction(settlement, i, 1.0);
}

/*
 * Lets frictions in planes that do not stick, and have stopped, slip along their last direction. False if values cannot
 * be evaluated.
 */
static bool let_stopped_head(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  if (switches->plane_count == 0) return true;
  if (evaluate_prepare(settlement->instance) != STATUS_DONE) return false;
  struct Point point = solver_point(settlement->instance, settlement->time, settlement->state);
  switches->switching_values(&point, settlement->acceleration, settlement->value);
  for (size_t i = 0; i < switches->plane_count; i++) {
    size_t along = switches->planes[i].along;
    if (!friction_sticks(settlement, along) && !(speed_in_plane(settlement, along) > least_speed))
      set_friction(settlement, along, 1.0);
  }
  return true;
}

/* Takes an impact of a contact and of those that are hit with it; leaves all contacts open. False if it fails. */
static bool take_impact(struct Settlement *settlement, size_t contact) {
  if (!choose_hit(settlement, contact)) return false;
  settlement_keep_modes(settlement);
  let_all_slide(settlement);
  open_all(settlement);
  bool done = impacts_take(settlement, settlement->impacts < IMPACT_LIMIT);
  settlement_restore_modes(settlement);
  open_all(settlement);
  let_go(settlement);
  settlement->jumped = true;
  settlement->impacts++;
  return done && let_stopped_head(settlement);
}

/* Logs singular equations, which name no contact by themselves; other reasons have been logged. */
static const char *refuse_singular_impact(const struct Settlement *settlement, size_t contact) {
  if (settlement->instance->singular != 0)
    log_message(settlement->instance, settlement_status(settlement),
                "time %g: the impact of the contact '%s' has no solution, as the equations of motion are singular "
                "without contacts; expected masses for all coordinates",
                settlement->time, settlement->switches->contacts[contact].name);
  return no_impact;
}

/* Largest error of an importer's integrator in one step, in units of the largest coordinate. */
static const double largest_step_error = 1e-4;

/*
 * True if an importer reaches the ground while the contact still parts: the error of its first step after the last impact exceeds the
 * height of the bounce, as that of the next first step would.
 */
static bool is_overtaken(const struct Settlement *settlement, size_t contact) {
  size_t gap = contact_place(settlement->switches, contact, CONTACT_GAP);
  const double *value = &settlement->value[gap], *noise = &settlement->noise[gap];
  bool has_jumped = settlement->jumped || settlement->moved || settlement->switched != NULL || settlement->set_mode;
  if (settlement->occasion != IN_EXCHANGE || has_jumped || !(value[CONTACT_GAP] < -noise[CONTACT_GAP])) return false;
  double height = 0.5 * value[CONTACT_RATE] * value[CONTACT_RATE] / -value[CONTACT_ACCELERATION];
  return value[CONTACT_RATE] > noise[CONTACT_RATE] &&
         height <= largest_step_error * largest_scale(settlement->state, 0);
}

/* True if an open contact touches, accelerates towards closing, and would only make bounces that errors hide. */
static bool comes_to_rest(const struct Settlement *settlement, size_t contact) {
  size_t acceleration = contact_place(settlement->switches, contact, CONTACT_ACCELERATION);
  if (settlement->was_opened[contact] != 0.0 || !is_touching(settlement, contact)) return false;
  if (!(-settlement->value[acceleration] > settlement->noise[acceleration])) return false;
  return is_overtaken(settlement, contact) ||
         bounce_is_lost(settlement, contact, contact_value(settlement, contact, CONTACT_RATE));
}

/* Lets frictions slide that stick at a velocity that an impact has set, before the velocities are projected. */
static void let_moving_slide(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  for (size_t i = 0; i < switches->friction_count && settlement->jumped; i++) {
    size_t place = friction_place(switches, i, FRICTION_VELOCITY);
    double velocity = settlement->value[place];
    if (!friction_sticks(settlement, i) || fabs(velocity) <= settlement_noise(settlement, place, place + FRICTION_RATE))
      continue;
    set_friction(settlement, i, velocity < 0.0 ? -1.0 : 1.0);
  }
}

/* Lets frictions stick that do not slide as the contact comes to rest: the projection of the gap would move them. */
static void let_stick(struct Settlement *settlement, size_t contact) {
  const struct SwitchTable *switches = settlement->switches;
  for (size_t i = 0; i < switches->friction_count; i++) {
    size_t velocity = friction_place(switches, i, FRICTION_VELOCITY);
    bool slides = sliding_speed(settlement, i) > settlement->noise[velocity];
    if (rests_on(switches, i, contact) && !slides) set_friction(settlement, i, 0.0);
  }
}

/*
 * True if a touching contact stays with others that come to rest. Rates of a body that comes to lie flat differ by
 * rounding errors, and the last contact does not accelerate by itself, but shares the load. was_opened is ignored: a
 * contact that pulled before the others came to rest may rest too.
 */
static bool rests_with_others(const struct Settlement *settlement, size_t contact) {
  size_t acceleration = contact_place(settlement->switches, contact, CONTACT_ACCELERATION);
  if (!is_touching(settlement, contact)) return false;
  if (settlement->value[acceleration] > settlement->noise[acceleration]) return false;
  return bounce_is_lost(settlement, contact, 0.5 * contact_value(settlement, contact, CONTACT_RATE));
}

static bool close_those(struct Settlement *settlement, bool (*rests)(const struct Settlement *, size_t)) {
  bool closes = false;
  for (size_t i = 0; i < settlement->switches->contact_count; i++) {
    if (contact_is_closed(settlement, i) || !rests(settlement, i)) continue;
    set_contact(settlement, i, true);
    let_stick(settlement, i);
    closes = true;
  }
  return closes;
}

/* Closes all contacts that come to rest, and, in this round and the next, those that stay with them. True if any. */
static bool close_contacts(struct Settlement *settlement) {
  bool comes = close_those(settlement, comes_to_rest), shares = comes || settlement->came_to_rest;
  settlement->came_to_rest = comes;
  if (!(shares && close_those(settlement, rests_with_others)) && !comes) return false;
  let_moving_slide(settlement);
  return true;
}

static const char *refuse_rest(const struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  size_t contact = 0;
  while (contact + 1 < switches->contact_count && !is_touching(settlement, contact)) contact++;
  log_message(settlement->instance, settlement_status(settlement),
              "time %g: no velocities are found with which the contact '%s' can close; expected another position, or "
              "fewer constraints",
              settlement->time, switches->contacts[contact].name);
  return no_impact;
}

/*
 * Returns a closed contact that accelerates towards closing although no force changes its gap; contact_count for none.
 */
static size_t find_prescribed(const struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  size_t contact = 0;
  while (contact < switches->contact_count &&
         (!contact_is_closed(settlement, contact) ||
          settlement_moves(settlement, switches->contacts[contact].constraint) ||
          contact_value(settlement, contact, CONTACT_ACCELERATION) >=
              -settlement->noise[contact_place(switches, contact, CONTACT_ACCELERATION)]))
    contact++;
  return contact;
}

/* Projects the velocities onto the contacts that have come to rest. NULL, or the reason why that fails. */
static const char *let_rest(struct Settlement *settlement) {
  if (!settlement_push(settlement)) return refuse_rest(settlement);
  size_t fixed = find_prescribed(settlement);
  if (fixed < settlement->switches->contact_count) {
    contact_forces_refuse_fixed(settlement, fixed);
    return no_impact;
  }
  return let_stopped_head(settlement) ? NULL : refuse_rest(settlement);
}

/* Returns the gap beyond which a closed contact was moved apart; larger for importers, whose states drift more. */
static double largest_drift(const struct Settlement *settlement) {
  return (settlement->occasion == IN_EXCHANGE ? 1e-3 : 1e-6) * largest_scale(settlement->state, 0);
}

/* Opens closed contacts that were moved apart. True if any. */
static bool open_lifted(struct Settlement *settlement) {
  bool opens = false;
  for (size_t i = 0; i < settlement->switches->contact_count; i++) {
    if (!contact_is_closed(settlement, i) || contact_value(settlement, i, CONTACT_GAP) <= largest_drift(settlement))
      continue;
    set_contact(settlement, i, false);
    opens = true;
  }
  return opens;
}

/* Opens closed contacts whose gap opens faster than errors, at a switch such as an edge or by an event. True if any. */
static bool open_parting(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  double drift = continuity_allowed_share(settlement) * largest_scale(settlement->state, lagrangian.coordinate_count);
  bool opens = false;
  for (size_t i = 0; i < switches->contact_count; i++) {
    size_t place = contact_place(switches, i, CONTACT_RATE);
    double rate = settlement->value[place], least = settlement->thrown ? settlement->noise[place] : drift;
    if (!contact_is_closed(settlement, i) || !(rate > least)) continue;
    set_contact(settlement, i, false);
    settlement->was_opened[i] = 1.0;
    opens = true;
  }
  return opens;
}

static bool part(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  open_lifted(settlement);
  for (size_t i = 0; i < switches->contact_count; i++) {
    double gap = contact_value(settlement, i, CONTACT_GAP);
    if (contact_is_closed(settlement, i) || gap >= -largest_drift(settlement)) continue;
    log_message(
        settlement->instance, STATUS_DISCARD,
        "time %g: after a parameter, an input or a state was set, the contact '%s' is penetrated: its gap is %g; "
        "expected values for which it is not negative",
        settlement->time, switches->contacts[i].name, gap);
    return false;
  }
  return true;
}

/*
 * True if the penetration of an open contact has to be projected out. An importer locates contacts late, and would not
 * see a zero of an indicator that stays negative. At an event this concerns a contact without speed, or one that has
 * just opened and that the projection onto other constraints has left penetrated; it would be located again and again.
 */
static bool has_to_lift(const struct Settlement *settlement, size_t contact) {
  size_t gap = contact_place(settlement->switches, contact, CONTACT_GAP), rate = gap + CONTACT_RATE;
  const double *value = settlement->value, *noise = settlement->noise;
  if (contact_is_closed(settlement, contact) || !(value[gap] < -noise[gap])) return false;
  if (!(value[gap] >= -largest_drift(settlement))) return false;
  bool has_stopped = settlement->jumped && value[rate] <= noise[rate];
  bool is_stuck = is_hit(settlement, contact_indicator(settlement->switches, contact)) && value[rate] >= 0.0;
  bool comes_again = (has_stopped || is_stuck) && value[gap] < -found_again * noise[gap];
  return settlement->occasion == IN_EXCHANGE || (settlement->occasion == AT_EVENT && comes_again);
}

/* Projects the penetrations of all such contacts to 0; *lifts if there are any. False if the projection fails. */
static bool lift(struct Settlement *settlement, bool *lifts) {
  *lifts = false;
  if (settlement->moved || settlement->lifts == LIFT_LIMIT) return true;
  settlement_keep_modes(settlement);
  for (size_t i = 0; i < settlement->switches->contact_count; i++) {
    if (!has_to_lift(settlement, i)) continue;
    set_contact(settlement, i, true);
    *lifts = true;
  }
  if (!*lifts) return true;
  settlement->lifts++;
  bool done = settlement_move(settlement);
  settlement_restore_modes(settlement);
  return done;
}

/* Undoes a projection at the start that has moved a fixed coordinate. True if it has. */
static bool undo_move_of_fixed(struct Settlement *settlement) {
  const bool *is_fixed = lagrangian.constraints.coordinate_is_fixed;
  bool moves = false;
  for (size_t i = 0; i < lagrangian.coordinate_count && is_fixed != NULL; i++)
    moves |= is_fixed[i] && fabs(settlement->correction[i]) > largest_penetration * scale_of(settlement->state, i);
  for (size_t i = 0; i < lagrangian.coordinate_count && moves; i++) settlement->state[i] -= settlement->correction[i];
  return moves;
}

/* True if the penetration of a contact may come from rounded start values. */
static bool is_rounded(const struct Settlement *settlement, size_t contact) {
  double gap = contact_value(settlement, contact, CONTACT_GAP);
  return gap < -largest_penetration && gap >= -rounded_start * largest_scale(settlement->state, 0);
}

/*
 * Projects out penetrations by rounded start values; takes_part keeps the most negative gap of each contact. True if
 * there are any, and they can be moved.
 */
static bool part_at_start(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  bool parts = false;
  settlement_keep_modes(settlement);
  for (size_t i = 0; i < switches->contact_count; i++) {
    if (!is_rounded(settlement, i)) continue;
    settlement->takes_part[i] = fmin(settlement->takes_part[i], contact_value(settlement, i, CONTACT_GAP));
    set_contact(settlement, i, true);
    parts = true;
  }
  parts = parts && settlement_move(settlement) && !undo_move_of_fixed(settlement);
  settlement_restore_modes(settlement);
  return parts;
}

static void log_parted(const struct Settlement *settlement) {
  for (size_t i = 0; i < settlement->switches->contact_count; i++)
    if (settlement->takes_part[i] < 0.0 && !is_rounded(settlement, i))
      log_message(settlement->instance, STATUS_DONE,
                  "time %g: the start values are moved to open the contact '%s', whose gap was %g", settlement->time,
                  settlement->switches->contacts[i].name, settlement->takes_part[i]);
}

static bool lift_start(struct Settlement *settlement) {
  int count = 0;
  for (size_t i = 0; i < settlement->switches->contact_count; i++) settlement->takes_part[i] = 0.0;
  while (count < LIFT_LIMIT && part_at_start(settlement)) {
    if (!settlement_evaluate(settlement)) return false;
    count++;
  }
  log_parted(settlement);
  return count == 0 || settlement_push(settlement);
}

/*
 * Returns the closed contact that pulls most; else one whose force has just reached 0, once an event; contact_count for
 * none.
 */
static size_t find_pulling(const struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  size_t found = switches->contact_count;
  double most = 0.0;
  for (size_t i = 0; i < switches->contact_count; i++) {
    if (!contact_is_closed(settlement, i)) continue;
    double force = contact_force(settlement, i);
    /* An importer stops at a zero or beyond it, and does not say of which indicator. */
    bool is_reached = is_hit(settlement, contact_indicator(settlement->switches, i)) ||
                      (settlement->occasion == IN_EXCHANGE && force <= 0.0);
    bool parts = is_reached && settlement->was_opened[i] == 0.0 && !settlement->jumped;
    if (!(force < 0.0) && !parts) continue;
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
static const char *check_values(const struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  for (size_t i = 0; i < switches->contact_count; i++) {
    bool has_gap = isfinite(contact_value(settlement, i, CONTACT_GAP));
    bool needs_rate = contact_is_closed(settlement, i) || is_touching(settlement, i);
    if (has_gap && (!needs_rate || isfinite(contact_value(settlement, i, CONTACT_RATE)))) continue;
    log_message(settlement->instance, settlement_status(settlement),
                "time %g: the gap of the contact '%s' has no finite %s, as where exp(x) overflows above x = 709; "
                "expected a gap that is finite",
                settlement->time, switches->contacts[i].name, has_gap ? "rate" : "value");
    return "a contact has no finite gap";
  }
  return NULL;
}

static const char *check_gaps(const struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  const char *problem = check_values(settlement);
  if (problem != NULL) return problem;
  bool starts = settlement->occasion == AT_START, moved = settlement->moved;
  double allowed = starts || moved ? largest_penetration : largest_drift(settlement);
  for (size_t i = 0; i < switches->contact_count; i++) {
    double gap = contact_value(settlement, i, CONTACT_GAP);
    if (gap >= -allowed) continue;
    log_message(
        settlement->instance, starts ? STATUS_ERROR : STATUS_DISCARD,
        "time %g: the contact '%s' is penetrated at %s: its gap is %g; expected %s for which it is not negative",
        settlement->time, switches->contacts[i].name,
        starts  ? "the start"
        : moved ? "an event that sets coordinates"
                : "an event that switches the gap",
        gap,
        starts  ? "start values or parameters"
        : moved ? "values of <set>"
                : "conditions and modes");
    return "a contact is penetrated";
  }
  return NULL;
}

static const char *act_once(struct Settlement *settlement, bool *again) {
  const struct SwitchTable *switches = settlement->switches;
  bool may_turn = may_turn_gaps(settlement) && settlement->occasion != AT_START;
  *again = true;
  const char *problem = check_values(settlement);
  if (problem != NULL) return problem;
  if ((settlement->moved || may_turn || settlement->occasion == IN_EXCHANGE) && open_lifted(settlement)) return NULL;
  if (may_turn && !settlement->jumped) problem = check_gaps(settlement);
  if (problem != NULL) return problem;
  if (((may_turn && !settlement->jumped) || settlement->thrown) && open_parting(settlement)) return NULL;
  size_t contact = find_impact(settlement);
  bool hits = contact<switches->contact_count, is_tried = settlement->impacts> IMPACT_LIMIT;
  if (hits && is_tried && closes_clearly(settlement, contact))
    return contact_forces_refuse_crushed(settlement, contact);
  if (hits && !is_tried) return take_impact(settlement, contact) ? NULL : refuse_singular_impact(settlement, contact);
  if (close_contacts(settlement)) return let_rest(settlement);
  bool lifts;
  if (!lift(settlement, &lifts)) return refuse_rest(settlement);
  if (lifts) return NULL;
  size_t pulling = find_pulling(settlement);
  *again = pulling < switches->contact_count;
  if (!*again) return NULL;
  settlement->was_opened[pulling] = 1.0;
  set_contact(settlement, pulling, false);
  let_go(settlement);
  return NULL;
}

const struct ContactLaws contact_laws = {.act = act_once,
                                         .settle_forces = contact_forces_settle,
                                         .share_load = contacts_share_load,
                                         .part = part,
                                         .lift_start = lift_start,
                                         .check_gaps = check_gaps,
                                         .explain = contact_forces_explain};
