/* Whether the forces of contacts at rest, with the frictions that slide on them, have a solution, and one alone. */
#ifndef CONTACT_FORCES_H
#define CONTACT_FORCES_H

#include "events/settlement.h"

/*
 * Opens and closes contacts at rest as the only solution says; *again where that changes any. NULL, or, after logging the
 * contact and the friction, the reason why the motion cannot go on.
 */
const char *contact_forces_settle(struct Settlement *settlement, bool *again);

/*
 * Logs a contact that closes whatever its impulse, with one that opposes it: prescribed motions crush what is between them.
 * Returns the reason why the motion cannot go on.
 */
const char *contact_forces_refuse_crushed(struct Settlement *settlement, size_t contact);

/* Logs a contact that closes, and whose gap no force changes. */
void contact_forces_refuse_fixed(const struct Settlement *settlement, size_t contact);

/* Where the motion ends: whether friction jams a contact that slides, which is logged. */
bool contact_forces_explain(struct Settlement *settlement);

#endif
