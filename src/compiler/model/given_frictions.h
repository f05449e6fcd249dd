/* Frictions along velocities that are given, by drives, inputs or time. */
#pragma once

#include "model/model.h"

/*
 * Makes the modes of such frictions branches, by the signs of their velocities, and their constraints empty: velocity = 0 would
 * contradict what is given. The modes of those in planes stay their own.
 */
void find_given_frictions(struct Model *model);
