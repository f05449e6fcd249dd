/* Impacts without collision: impulses that end the slip of contacts without forces, or forces that a search missed. */
#pragma once

#include "nonsmooth/resolution.h"

/*
 * Changes the velocities by the impulses of a short step that end a slip, and leaves all contacts open. If the impulses
 * are those of finite forces, it sets the modes by these. False if there are none, or one contact alone touches, whose
 * paradox most often is an error of the model.
 */
bool end_slip(struct Resolution *resolution);
