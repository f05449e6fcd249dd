/* Stops of slow frictions in planes: decides whether the whole motion stops with them. */
#pragma once

#include "nonsmooth/planes/plane_state.h"

/*
 * Sets *stops if the motion stops with its slow frictions: the velocities do not change by much more than they would
 * until the slip ends. A point may be slow in a motion that is not, as the end of an arm that is nearly straight. False
 * if that cannot be determined.
 */
bool plane_stops_motion(struct Resolution *resolution, bool *stops);
