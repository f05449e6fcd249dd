/* Dry friction: stick and slip, for struct FrictionLaws. Frictions in planes are only reported and checked here. */
#ifndef FRICTIONS_H
#define FRICTIONS_H

#include "events/settlement.h"

const char *frictions_act(struct Settlement *settlement, bool *again);
bool frictions_tell(struct Settlement *settlement, bool *again);
const char *frictions_check(struct Settlement *settlement);

/*
 * Sets *held if others constrain the velocity, in a plane both, of a friction that counts as sliding. False if that
 * cannot be determined.
 */
bool frictions_find_held(struct Settlement *settlement, size_t friction, bool *held);

/* Logs a friction without a consistent mode; returns the reason why the motion cannot go on. */
const char *frictions_refuse(const struct Settlement *settlement, size_t friction);

/* Logs that something is missing, and the friction that switched most often. */
void frictions_blame(const struct Settlement *settlement, const char *missing);

/*
 * Logs a friction that slides and jams the constraint from whose force it follows; false if none does. branch: the one
 * that switches without end by that force; branch_count if accelerations do not exist.
 */
bool frictions_explain_jam(struct Settlement *settlement, size_t branch);

/* Lets frictions slide that stick although a new parameter or state gives them a velocity. */
void frictions_release(struct Settlement *settlement);

/* Largest rate of a velocity that friction holds, relative to its largest rate in the event. */
extern const double friction_held_share;

/* Switches of one friction in an event resolution before they count as endless. */
enum { FRICTION_FLIP_LIMIT = 500 };

#endif
