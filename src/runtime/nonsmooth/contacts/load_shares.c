/*
 * Closes redundant contacts at rest. A body on more contacts than it needs rests on any sufficient set of them. The
 * set that an event leaves closed depends on the order in which contacts closed and opened. To make the forces
 * depend only on the load, all that touch at rest are closed. The equations of motion then have the constraint
 * forces of least norm. Contacts among them that pull, or carry nothing, are opened one by one, the most negative
 * force first (an active set method). It ends since each round opens one. If a closed contact still pulls, the
 * modes stay as they were. This is tried once an event resolution, after contact_forces.c.
 */
#include "nonsmooth/contacts/load_shares.h"

#include <math.h>

#include "nonsmooth/contacts/planes.h"
#include "nonsmooth/contacts/contact_impulses.h"
#include "nonsmooth/contacts/resting_forces.h"
#include "nonsmooth/tolerances.h"
#include "evaluation/evaluate.h"

/* True if no friction on the contact slides. */
static bool sticks_sideways(const struct Resolution *resolution, size_t contact, double slowest) {
  const struct SwitchTable *switches = resolution->switches;
  bool slides = false;
  for (size_t i = 0; i < switches->friction_count; i++)
    slides |= rests_on(switches, i, contact) && sliding_speed(resolution, i) > slowest;
  return !slides;
}

/* Lets open contacts take part that touch at rest, and do not part. True if there are any beside a closed contact. */
static bool find_idle(struct Resolution *resolution) {
  const struct Tolerances tolerances = tolerances_of(resolution);
  bool has_closed = false, is_idle = false;
  for (size_t i = 0; i < resolution->switches->contact_count; i++) {
    bool is_closed = contact_is_closed(resolution, i);
    bool touches = fabs(contact_value(resolution, i, CONTACT_GAP)) <= tolerances.touching;
    bool is_still = fabs(contact_value(resolution, i, CONTACT_RATE)) <= tolerances.rest;
    bool parts = contact_value(resolution, i, CONTACT_ACCELERATION) > rounded_acceleration_of_gap(resolution, i);
    bool rests = !is_closed && touches && is_still && !parts && sticks_sideways(resolution, i, tolerances.rest);
    resolution->part[i] = rests ? TAKES_PART : LEFT_OUT;
    has_closed |= is_closed;
    is_idle |= rests;
  }
  return has_closed && is_idle;
}

/* Closes the contacts that take part. The others no longer carry a force, of which these then have a share. */
static void close_idle(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->contact_count; i++) {
    if (contact_is_closed(resolution, i)) set_contact(resolution, i, true);
    if (resolution->part[i] == LEFT_OUT) continue;
    set_contact(resolution, i, true);
    for (size_t f = 0; f < switches->friction_count; f++)
      if (rests_on(switches, f, i)) set_friction(resolution, f, 0.0);
  }
}

/* Returns the contact with the least force, of those that were closed here and do not press; contact_count for none. */
static size_t find_useless(const struct Resolution *resolution) {
  size_t count = resolution->switches->contact_count, found = count;
  double largest = largest_contact_force(resolution), least = INFINITY;
  for (size_t i = 0; i < count; i++) {
    double force = contact_force(resolution, i);
    if (resolution->part[i] == LEFT_OUT || force > rounded_force * largest || force >= least) continue;
    least = force;
    found = i;
  }
  return found;
}

static bool any_takes_part(const struct Resolution *resolution) {
  bool any = false;
  for (size_t i = 0; i < resolution->switches->contact_count; i++) any |= resolution->part[i] != LEFT_OUT;
  return any;
}

static bool any_is_in_tension(const struct Resolution *resolution) {
  bool any = false;
  for (size_t i = 0; i < resolution->switches->contact_count; i++)
    any |= contact_is_closed(resolution, i) && contact_force(resolution, i) < 0.0;
  return any;
}

/*
 * Closes the contacts that take part and press. True if all closed contacts press then; else the caller restores modes.
 */
static bool close_useful(struct Resolution *resolution) {
  size_t count = resolution->switches->contact_count, useless;
  do {
    resolution_restore_modes(resolution);
    if (!any_takes_part(resolution)) return false;
    close_idle(resolution);
    if (!resolution_evaluate(resolution)) return false;
    useless = find_useless(resolution);
    if (useless < count) resolution->part[useless] = LEFT_OUT;
  } while (useless < count);
  return !any_is_in_tension(resolution);
}

const char *contacts_share_load(struct Resolution *resolution, bool *again) {
  bool changed = resolution->changed;
  *again = false;
  if (resolution->has_shared || !find_idle(resolution)) return NULL;
  resolution->has_shared = true;
  resolution_keep_modes(resolution);
  *again = close_useful(resolution);
  if (*again) return NULL;
  resolution_restore_modes(resolution);
  resolution->changed = changed;
  return resolution_evaluate(resolution) ? NULL : "the accelerations do not exist after an event";
}
