/*
 * A branch that switches must leave positions and velocities as they are: neither constraints nor energies may jump there.
 * How velocities would have to jump with them, the system does not tell.
 */
#ifndef CONTINUITY_H
#define CONTINUITY_H

#include "events/settlement.h"

/* Takes up what the solver has left of the constraints. NULL, or why the motion cannot go on. */
const char *continuity_begin(struct Settlement *settlement);

/* Before a branch switches: how things are until then. */
void continuity_note(struct Settlement *settlement, size_t branch);

/* Behind all: whether branches, or events that set modes or coordinates, have left things in their places. */
const char *continuity_check(struct Settlement *settlement);

/* How far a branch without a kink may move the state, in units of its scales: an importer comes to it late. */
double continuity_allowed_share(const struct Settlement *settlement);

/*
 * Logs the contact whose gap has a corner, or a jump, where a branch switches: a body that touches both of its pieces needs a
 * contact for each of them. False where there is none.
 */
bool continuity_explain_corner(struct Settlement *settlement, size_t branch);

/* The reason where they cannot. */
extern const char constraints_not_kept[];

#endif
