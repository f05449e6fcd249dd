/* Impacts without collision: impulses that end the slip of contacts without forces. */
#pragma once

#include "nonsmooth/resolution.h"

/*
 * Changes the velocities by the impulses of a short step that end a slip, and leaves all contacts open. False if the
 * impulses are those of finite forces, or one contact alone touches, whose paradox most often is an error of the model.
 */
bool end_slip(struct Resolution *resolution);
