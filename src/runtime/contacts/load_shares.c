/*
 * A body on more contacts than it needs rests on any of them alike. Which of them an event leaves open depends on the order in
 * which they closed, pulled and opened; the forces are to depend on the load alone, and to be the ones of least norm.
 */
#include "contacts/load_shares.h"

#include <math.h>

#include "contacts/planes.h"
#include "contacts/pushes.h"
#include "contacts/resting_forces.h"
#include "evaluation/evaluate.h"

static double force_of(const struct Settlement *settlement, size_t contact) {
  size_t constraint = settlement->switches->contacts[contact].constraint;
  return settlement->acceleration[lagrangian.coordinate_count + constraint];
}

/* Speeds up to this are those of what rests. */
static double slowest(const struct Settlement *settlement) {
  double share = settlement->occasion == IN_EXCHANGE ? 1e-6 : 1e-9;
  return share * largest_scale(settlement->state, lagrangian.coordinate_count);
}

/* Gaps up to this are left by the projection of what holds. */
static double narrowest(const struct Settlement *settlement) {
  double share = settlement->occasion == IN_EXCHANGE ? 1e-9 : 1e-12;
  return share * largest_scale(settlement->state, 0);
}

/* Whether nothing slides on it. */
static bool is_held_aside(const struct Settlement *settlement, size_t contact) {
  const struct SwitchTable *switches = settlement->switches;
  bool slides = false;
  for (size_t i = 0; i < switches->friction_count; i++)
    slides |= rests_on(switches, i, contact) && sliding_speed(settlement, i) > slowest(settlement);
  return !slides;
}

/* Notes in takes_part what touches at rest and is open. Whether there is any, and anything closed that holds it. */
static bool find_idle(struct Settlement *settlement) {
  bool is_held = false, is_idle = false;
  for (size_t i = 0; i < settlement->switches->contact_count; i++) {
    bool is_closed = contact_is_closed(settlement, i);
    bool is_touching = fabs(contact_value(settlement, i, CONTACT_GAP)) <= narrowest(settlement);
    bool is_still = fabs(contact_value(settlement, i, CONTACT_RATE)) <= slowest(settlement);
    bool rests = !is_closed && is_touching && is_still && is_held_aside(settlement, i);
    settlement->takes_part[i] = rests ? 1.0 : 0.0;
    is_held |= is_closed;
    is_idle |= rests;
  }
  return is_held && is_idle;
}

static void close_idle(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  for (size_t i = 0; i < switches->contact_count; i++) {
    if (settlement->takes_part[i] == 0.0) continue;
    set_contact(settlement, i, true);
    for (size_t f = 0; f < switches->friction_count; f++)
      if (rests_on(switches, f, i)) set_friction(settlement, f, 0.0);
  }
}

/* What pulls most of those that were closed, or carries nothing; contact_count where each presses. */
static size_t find_useless(const struct Settlement *settlement) {
  size_t count = settlement->switches->contact_count, found = count;
  double largest = 0.0, least = INFINITY;
  for (size_t i = 0; i < count; i++)
    if (contact_is_closed(settlement, i)) largest = fmax(largest, fabs(force_of(settlement, i)));
  for (size_t i = 0; i < count; i++) {
    double force = force_of(settlement, i);
    if (settlement->takes_part[i] == 0.0 || force > rounded_force * largest || force >= least) continue;
    least = force;
    found = i;
  }
  return found;
}

static bool any_takes_part(const struct Settlement *settlement) {
  bool any = false;
  for (size_t i = 0; i < settlement->switches->contact_count; i++) any |= settlement->takes_part[i] != 0.0;
  return any;
}

static bool any_pulls(const struct Settlement *settlement) {
  bool pulls = false;
  for (size_t i = 0; i < settlement->switches->contact_count; i++)
    pulls |= contact_is_closed(settlement, i) && force_of(settlement, i) < 0.0;
  return pulls;
}

const char *contacts_share_load(struct Settlement *settlement, bool *again) {
  bool changed = settlement->changed, is_known = true;
  *again = false;
  if (settlement->has_shared || !find_idle(settlement)) return NULL;
  settlement->has_shared = true;
  settlement_keep_modes(settlement);
  for (size_t useless = settlement->switches->contact_count; is_known && any_takes_part(settlement);) {
    settlement_restore_modes(settlement);
    close_idle(settlement);
    is_known = settlement_evaluate(settlement);
    useless = is_known ? find_useless(settlement) : useless;
    if (useless == settlement->switches->contact_count) break;
    settlement->takes_part[useless] = 0.0;
  }
  *again = is_known && any_takes_part(settlement) && !any_pulls(settlement);
  if (*again) return NULL;
  settlement_restore_modes(settlement);
  settlement->changed = changed;
  return settlement_evaluate(settlement) ? NULL : "there are no accelerations at an event";
}
