/* Dry friction: which slides, which sticks. As in struct FrictionLaws; frictions in a plane are only told and checked. */
#ifndef FRICTIONS_H
#define FRICTIONS_H

#include "events/settlement.h"

const char *frictions_act(struct Settlement *settlement, bool *again);
bool frictions_tell(struct Settlement *settlement, bool *again);
const char *frictions_check(struct Settlement *settlement);

/*
 * Whether a friction that counts as sliding has a velocity, or two in a plane, that others hold: *held. False where that cannot
 * be told.
 */
bool frictions_find_held(struct Settlement *settlement, size_t friction, bool *held);

/* Where no mode of a friction lasts: logs it. Returns the reason why the motion cannot go on. */
const char *frictions_refuse(const struct Settlement *settlement, size_t friction);

/* Logs that something is not found there, with the friction that switched most. */
void frictions_blame(const struct Settlement *settlement, const char *missing);

/*
 * Logs a friction that slides and jams the constraint whose force it follows from; false where none does. branch: the one that
 * switches without end by that force; branch_count where there are no accelerations.
 */
bool frictions_explain_jam(struct Settlement *settlement, size_t branch);

/* Lets those slide that stick although a parameter or a state was set so that their velocity is not 0. */
void frictions_release(struct Settlement *settlement);

/* Of the rate of a velocity, what is left of it at most where friction holds that. */
extern const double friction_held_share;

/* So often may one switch in a settlement. */
enum { FRICTION_FLIP_LIMIT = 500 };

#endif
