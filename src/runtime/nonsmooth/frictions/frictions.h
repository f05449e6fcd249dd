/* Dry friction: stick and slip, for struct FrictionLaws. Frictions in planes are only reported and checked here. */
#pragma once

#include "nonsmooth/resolution.h"

/* Implement the functions of these names in struct FrictionLaws. */
bool frictions_slide_unheld(struct Resolution *resolution);
const char *frictions_act(struct Resolution *resolution, bool *again);
bool frictions_report(struct Resolution *resolution, bool *again);
const char *frictions_check(struct Resolution *resolution);

/*
 * Sets *is_constrained if other constraints fix the velocity of a friction, in a plane both velocities. False if that
 * cannot be determined.
 */
bool frictions_find_constrained(struct Resolution *resolution, size_t friction, bool *is_constrained);

/* Logs a friction without a consistent mode; returns the reason why the motion cannot continue. */
const char *frictions_report_inconsistent(const struct Resolution *resolution, size_t friction);

/* Logs what is missing, such as the accelerations, with the name of the friction that switched most often. */
void frictions_report_missing(const struct Resolution *resolution, const char *missing);

/*
 * Logs a friction that slides and jams the constraint from whose force it follows; false if none does. branch: the one
 * that keeps switching by that force; branch_count if accelerations do not exist.
 */
bool frictions_explain_jam(struct Resolution *resolution, size_t branch);

/* True if a friction along a line sticks, or slides without a velocity. */
bool friction_rests(const struct Resolution *resolution, size_t friction);

/* True if a friction along a line has equal limits in both directions. Its velocity is not prescribed. */
bool friction_is_even(const struct Resolution *resolution, size_t friction);

/* True if such a friction acts with its limit although it neither moves nor accelerates. */
bool friction_rests_at_limit(const struct Resolution *resolution, size_t friction);

/* True if such a friction sticks, and needs more than its stiction. */
bool friction_is_overcome(const struct Resolution *resolution, size_t friction);

/* Sets the mode of a friction along a line. Leaving rest, it acts with its stiction as long as others hold it. */
void friction_switch(struct Resolution *resolution, size_t friction, double mode);

/* Lets frictions slide that stick although a new parameter or state gives them a velocity. */
void frictions_release(struct Resolution *resolution);

/* Largest rate of a velocity that friction holds, relative to its largest rate in the event. */
extern const double sticking_rate_share;

/* Switches of one friction in an event resolution before they count as endless. */
enum { FRICTION_FLIP_LIMIT = 500 };
