/*
 * Closes redundant contacts at rest. A body on more contacts than it needs rests on any sufficient set of them. The
 * set that an event leaves closed depends on the order in which contacts closed and opened. To make the forces
 * depend only on the load, all that touch at rest are closed. The equations of motion then have the constraint
 * forces of least norm. Contacts among them that pull, or carry nothing, are opened again (find_pulling() in
 * contacts.c). Each is closed here at most once an event, so that the rounds end.
 */
#include "nonsmooth/contacts/load_shares.h"

#include <math.h>

#include "nonsmooth/contacts/planes.h"
#include "nonsmooth/contacts/contact_impulses.h"
#include "nonsmooth/tolerances.h"

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
  const struct Tolerances tolerances = resolution->tolerances;
  bool has_closed = false, is_idle = false;
  for (size_t i = 0; i < resolution->switches->contact_count; i++) {
    bool is_closed = contact_is_closed(resolution, i);
    bool touches = fabs(contact_value(resolution, i, CONTACT_GAP)) <= tolerances.touching;
    bool is_still = fabs(contact_value(resolution, i, CONTACT_RATE)) <= tolerances.rest;
    bool parts = contact_value(resolution, i, CONTACT_ACCELERATION) > rounded_acceleration_of_gap(resolution, i);
    bool rests = !is_closed && !resolution->has_shared[i] && touches && is_still && !parts &&
                 sticks_sideways(resolution, i, tolerances.rest);
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
    resolution->forced[i] = SHARES_LOAD;
    resolution->has_shared[i] = true;
    for (size_t f = 0; f < switches->friction_count; f++)
      if (rests_on(switches, f, i)) set_friction(resolution, f, 0.0);
  }
}

bool contacts_share_load(struct Resolution *resolution) {
  bool is_idle = find_idle(resolution);
  if (is_idle) close_idle(resolution);
  return is_idle;
}
