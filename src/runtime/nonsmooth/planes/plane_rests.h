/* Frictions in planes at rest: which stick, which begin to slide, and along which directions. */
#pragma once

#include "nonsmooth/planes/plane_state.h"

/* True if a sliding friction has to be tried to stick. */
bool plane_is_stopping(const struct Resolution *resolution, const struct PlaneState *state);

/* True if a friction sticks, and its velocity changes nevertheless: its constraint contradicts others. */
bool plane_is_unheld(const struct Resolution *resolution, const struct PlaneState *state);

/*
 * True if a friction that sticks has a force far beyond all limits, where constraints nearly depend on each other. The
 * rounding error bound of such a force is as large, and hides that it is overcome.
 */
bool plane_is_lost(const struct Resolution *resolution, const struct PlaneState *state);

/* True if a sticking friction needs more than its stiction, or was found to reach it. */
bool plane_is_overcome(const struct Resolution *resolution, const struct PlaneState *state);

/*
 * Brings slow frictions to rest, and sets the modes of all at rest. Those that must slip begin along the directions
 * with which all conditions hold. False, without a message, if none are found, or accelerations do not exist.
 */
bool plane_rests_find(struct Resolution *resolution);

/*
 * The same with the forces of all contacts at rest, which may open or close. False also on further calls in an event
 * resolution.
 */
bool plane_rests_find_with_contacts(struct Resolution *resolution);

/* The same from the forces in guess[]. Slow frictions slide on unless the motion stops. */
bool plane_rests_continue(struct Resolution *resolution, bool stops);
