/*
 * Contacts: impacts, rest, and parting. Impacts come one after another, that of the fastest first, each by Newton's law of
 * restitution through M; what a contact beside would then have to take comes as an impact of its own, so that a row of
 * touching bodies hands a push on. Friction that rests on the force of a contact takes its part in the impact by Coulomb's
 * law.
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "settlement.h"

enum { IMPACT_LIMIT = 1000, LIFT_LIMIT = 20 };

/* A contact comes to rest where its next flight is not longer than the time can tell, in units of its last place. */
static const double shortest_flight = 1000.0;
/* How far a contact may be penetrated where it is set. */
static const double largest_penetration = 1e-9;

static const char no_impact[] = "a contact cannot take an impact there";

static bool is_touching(const struct Settlement *settlement, size_t contact) {
  size_t gap = contact_place(settlement, contact, CONTACT_GAP);
  double noise = settlement_noise(settlement, gap, gap + CONTACT_RATE);
  return settlement->value[gap] <= noise || is_hit(settlement, indicator_of_contact(settlement, contact));
}

/* The touching contact that closes fastest; contact_count for none. */
static size_t find_impact(const struct Settlement *settlement) {
  size_t found = settlement->switches->contact_count;
  double fastest = 0.0;
  for (size_t i = 0; i < settlement->switches->contact_count; i++) {
    size_t rate = contact_place(settlement, i, CONTACT_RATE);
    bool is_open =
        mode_of(settlement, settlement->switches->contacts[i].mode) == 0.0 && settlement->was_opened[i] == 0.0;
    bool is_hit_first = is_hit(settlement, indicator_of_contact(settlement, i)) && is_open && settlement->impacts == 0;
    bool closes = settlement->value[rate] < (is_hit_first ? 0.0 : -settlement->noise[rate]);
    if (!closes || !is_touching(settlement, i) || settlement->value[rate] >= fastest) continue;
    fastest = settlement->value[rate];
    found = i;
  }
  return found;
}

static void open_all(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  for (size_t i = 0; i < switches->contact_count; i++) settlement_set_mode(settlement, switches->contacts[i].mode, 0.0);
}

/* Whether the friction follows from the force of the contact. */
static bool rests_on(const struct SwitchTable *switches, size_t friction, size_t contact) {
  return switches->rests_on != NULL && switches->rests_on[friction * switches->contact_count + contact];
}

/* Frictions that slide before the impact, as they do then; others take no part, or stick. */
static void set_frictions(struct Settlement *settlement, size_t contact) {
  const struct SwitchTable *switches = settlement->switches;
  for (size_t i = 0; i < switches->friction_count; i++) {
    size_t place = friction_place(settlement, i, FRICTION_VELOCITY);
    double velocity = settlement->value[place], mode = velocity < 0.0 ? -1.0 : 1.0;
    bool sticks = fabs(velocity) <= settlement_noise(settlement, place, place + FRICTION_RATE);
    bool takes_part = rests_on(switches, i, contact);
    settlement_set_mode(settlement, switches->frictions[i].mode, !takes_part ? 1.0 : sticks ? 0.0 : mode);
  }
}

/* The values behind a push; the noise of the present ones is not needed any more. */
static const double *values_behind(struct Settlement *settlement) {
  return settlement_values(settlement, settlement->state, settlement->noise) ? settlement->noise : NULL;
}

/* Lets those frictions stick whose velocity the push has turned round. Whether there are any, or were before. */
static bool let_stick(struct Settlement *settlement, const double *value, size_t contact) {
  const struct SwitchTable *switches = settlement->switches;
  bool any = false;
  for (size_t i = 0; i < switches->friction_count; i++) {
    size_t mode = switches->frictions[i].mode, place = friction_place(settlement, i, FRICTION_VELOCITY);
    if (!rests_on(switches, i, contact)) continue;
    if (mode_of(settlement, mode) * value[place] < 0.0) settlement_set_mode(settlement, mode, 0.0);
    any |= mode_of(settlement, mode) == 0.0;
  }
  return any;
}

/*
 * An impact with friction that sticks: first the friction alone, then both, so that what sticks stays and the contact parts
 * as fast as restitution says.
 */
static bool push_sticking(struct Settlement *settlement, size_t contact, double restitution, double rate) {
  const struct ContactFacts *facts = &settlement->switches->contacts[contact];
  settlement_set_mode(settlement, facts->mode, 0.0);
  const double *value = settlement_push(settlement, 1.0) ? values_behind(settlement) : NULL;
  if (value == NULL) return false;
  double closing = value[contact_place(settlement, contact, CONTACT_RATE)];
  settlement_set_mode(settlement, facts->mode, 1.0);
  return settlement_push(settlement, closing < 0.0 ? 1.0 + restitution * rate / closing : 1.0);
}

/* Newton's law for one contact by itself, with the frictions that rest on it. */
static bool push(struct Settlement *settlement, size_t contact, double restitution) {
  double rate = settlement->value[contact_place(settlement, contact, CONTACT_RATE)];
  size_t bytes = lagrangian.coordinate_count * sizeof(double);
  double *velocity = settlement->state + lagrangian.coordinate_count;
  memcpy(settlement->kept_velocities, velocity, bytes);
  if (!settlement_push(settlement, 1.0 + restitution)) return false;
  if (settlement->switches->rests_on == NULL) return true;
  const double *value = values_behind(settlement);
  if (value == NULL) return false;
  if (!let_stick(settlement, value, contact)) return true;
  memcpy(velocity, settlement->kept_velocities, bytes);
  return push_sticking(settlement, contact, restitution, rate);
}

static double *modes_of(const struct Settlement *settlement) {
  return settlement->instance->parameter + lagrangian.parameter_count - settlement->switches->mode_count;
}

static void keep_modes(struct Settlement *settlement) {
  memcpy(settlement->kept_modes, modes_of(settlement), settlement->switches->mode_count * sizeof(double));
}

static void restore_modes(struct Settlement *settlement) {
  memcpy(modes_of(settlement), settlement->kept_modes, settlement->switches->mode_count * sizeof(double));
  settlement->instance->prepared_is_stale = true;
}

static bool take_impact(struct Settlement *settlement, size_t contact) {
  const struct SwitchTable *switches = settlement->switches;
  double restitution = settlement->value[contact_place(settlement, contact, CONTACT_RESTITUTION)];
  if (!(restitution >= 0.0 && restitution <= 1.0)) {
    log_message(settlement->instance, STATUS_DISCARD,
                "time %g: the restitution of the contact '%s' is %g; expected one from 0 to 1", settlement->time,
                switches->contacts[contact].name, restitution);
    return false;
  }
  keep_modes(settlement);
  set_frictions(settlement, contact);
  open_all(settlement);
  settlement_set_mode(settlement, switches->contacts[contact].mode, 1.0);
  bool done = push(settlement, contact, restitution);
  restore_modes(settlement);
  open_all(settlement);
  settlement->jumped = true;
  settlement->was_opened[contact] = 0.0;
  settlement->impacts++;
  return done;
}

/* Whether an open contact that touches would come back at once. */
static bool comes_to_rest(const struct Settlement *settlement, size_t contact) {
  size_t gap = contact_place(settlement, contact, CONTACT_GAP);
  const double *value = &settlement->value[gap];
  double rate = fmax(value[CONTACT_RATE], 0.0), fall = -value[CONTACT_ACCELERATION];
  if (settlement->was_opened[contact] != 0.0 || !is_touching(settlement, contact)) return false;
  if (!(fall > settlement->noise[gap + CONTACT_ACCELERATION])) return false;
  double start = settlement->instance->situation->start_time;
  double resolution = DBL_EPSILON * fmax(fabs(settlement->time), fabs(settlement->time - start));
  /* An importer may come below the ground, and finds no further zero there. */
  bool is_below = settlement->occasion == IN_EXCHANGE && value[CONTACT_GAP] < 0.0;
  if (is_below && rate * rate / (2.0 * fall) <= -10.0 * value[CONTACT_GAP]) return true;
  return rate <= settlement->noise[gap + CONTACT_RATE] || 2.0 * rate / fall <= shortest_flight * resolution ||
         rate * rate / (2.0 * fall) <= 4.0 * settlement_noise(settlement, gap, gap + CONTACT_RATE);
}

/* Closes contacts that come to rest, all at once. */
static bool close_contacts(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  bool closes = false;
  for (size_t i = 0; i < switches->contact_count; i++) {
    bool is_open = mode_of(settlement, switches->contacts[i].mode) == 0.0;
    if (!is_open || !comes_to_rest(settlement, i)) continue;
    settlement_set_mode(settlement, switches->contacts[i].mode, 1.0);
    closes = true;
  }
  return closes;
}

/* How far a contact must be moved apart to open, in units of the largest coordinate; importers keep constraints less well. */
static double largest_drift(const struct Settlement *settlement) {
  double scale = 0.0;
  for (size_t i = 0; i < lagrangian.coordinate_count; i++)
    scale = fmax(scale, fmax(fabs(settlement->state[i]), lagrangian.nominal[i]));
  return (settlement->occasion == IN_EXCHANGE ? 1e-3 : 1e-6) * scale;
}

/* Opens contacts that were lifted. Whether there were any. */
static bool open_lifted(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  bool opens = false;
  for (size_t i = 0; i < switches->contact_count; i++) {
    size_t gap = contact_place(settlement, i, CONTACT_GAP);
    bool is_closed = mode_of(settlement, switches->contacts[i].mode) != 0.0;
    if (!is_closed || settlement->value[gap] <= largest_drift(settlement)) continue;
    settlement_set_mode(settlement, switches->contacts[i].mode, 0.0);
    opens = true;
  }
  return opens;
}

/* Opens contacts whose gap has just turned away, as at an edge. Whether there were any. */
static bool open_turned(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  double least = continuity_allowed_share(settlement) * settlement_velocity_scale(settlement);
  bool opens = false;
  for (size_t i = 0; i < switches->contact_count; i++) {
    double rate = settlement->value[contact_place(settlement, i, CONTACT_RATE)];
    if (mode_of(settlement, switches->contacts[i].mode) == 0.0 || !(rate > least)) continue;
    settlement_set_mode(settlement, switches->contacts[i].mode, 0.0);
    settlement->was_opened[i] = 1.0;
    opens = true;
  }
  return opens;
}

static bool release(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  open_lifted(settlement);
  for (size_t i = 0; i < switches->contact_count; i++) {
    double gap = settlement->value[contact_place(settlement, i, CONTACT_GAP)];
    bool is_closed = mode_of(settlement, switches->contacts[i].mode) != 0.0;
    if (is_closed || gap >= -largest_drift(settlement)) continue;
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
 * An importer comes to a contact late, and an indicator that stays below 0 would not be seen again. Moves apart what is open
 * and stands in one another by so little, all at once; *lifts where there is any. False where that cannot be.
 */
static bool lift(struct Settlement *settlement, bool *lifts) {
  const struct SwitchTable *switches = settlement->switches;
  *lifts = false;
  if (settlement->occasion != IN_EXCHANGE || settlement->moved || settlement->lifts == LIFT_LIMIT) return true;
  keep_modes(settlement);
  for (size_t i = 0; i < switches->contact_count; i++) {
    double gap = settlement->value[contact_place(settlement, i, CONTACT_GAP)];
    double noise = settlement->noise[contact_place(settlement, i, CONTACT_GAP)];
    bool is_open = mode_of(settlement, switches->contacts[i].mode) == 0.0;
    if (!is_open || !(gap < -noise) || !(gap >= -largest_drift(settlement))) continue;
    settlement_set_mode(settlement, switches->contacts[i].mode, 1.0);
    *lifts = true;
  }
  if (!*lifts) return true;
  settlement->lifts++;
  bool done = settlement_move(settlement);
  restore_modes(settlement);
  return done;
}

/* The closed contact that pulls most, or whose force has just gone; contact_count for none. */
static size_t find_pulling(const struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  size_t found = switches->contact_count;
  double most = 0.0;
  for (size_t i = 0; i < switches->contact_count; i++) {
    const struct ContactFacts *contact = &switches->contacts[i];
    if (mode_of(settlement, contact->mode) == 0.0) continue;
    double force = settlement->acceleration[lagrangian.coordinate_count + contact->constraint];
    /* An importer comes to a zero or past it, and does not tell whose. */
    bool is_reached = is_hit(settlement, indicator_of_contact(settlement, i)) ||
                      (settlement->occasion == IN_EXCHANGE && force <= 0.0);
    bool parts = is_reached && settlement->was_opened[i] == 0.0 && !settlement->jumped;
    if (!(force < 0.0) && !parts) continue;
    if (found < switches->contact_count && fmin(force, 0.0) >= most) continue;
    most = fmin(force, 0.0);
    found = i;
  }
  return found;
}

static const char *check_gaps(const struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  bool starts = settlement->occasion == AT_START, moved = settlement->moved;
  double allowed = starts || moved ? largest_penetration : largest_drift(settlement);
  for (size_t i = 0; i < switches->contact_count; i++) {
    double gap = settlement->value[contact_place(settlement, i, CONTACT_GAP)];
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
  if ((settlement->moved || may_turn || settlement->occasion == IN_EXCHANGE) && open_lifted(settlement)) return NULL;
  const char *problem = may_turn && !settlement->jumped ? check_gaps(settlement) : NULL;
  if (problem != NULL) return problem;
  if (may_turn && !settlement->jumped && open_turned(settlement)) return NULL;
  size_t contact = find_impact(settlement);
  if (contact < switches->contact_count && settlement->impacts < IMPACT_LIMIT)
    return take_impact(settlement, contact) ? NULL : no_impact;
  if (contact < switches->contact_count) { /* a push that goes to and fro dies away */
    settlement_set_mode(settlement, switches->contacts[contact].mode, 1.0);
    return settlement_push(settlement, 1.0) ? NULL : no_impact;
  }
  if (close_contacts(settlement)) return settlement_push(settlement, 1.0) ? NULL : no_impact;
  bool lifts;
  if (!lift(settlement, &lifts)) return no_impact;
  if (lifts) return NULL;
  size_t pulling = find_pulling(settlement);
  *again = pulling < switches->contact_count;
  if (!*again) return NULL;
  settlement->was_opened[pulling] = 1.0;
  settlement_set_mode(settlement, switches->contacts[pulling].mode, 0.0);
  return NULL;
}

const struct ContactLaws contact_laws = {.act = act_once, .release = release, .check_gaps = check_gaps};
