/* The forces of least norm along a direction, where constraints follow from others, as instructions. */
#pragma once

#include "program/program.h"

/*
 * The targets hold the accelerations and some forces of constraints along the direction, and the space of accelerations
 * those at the point, with the forces of least norm: makes the former those of least norm too.
 */
void append_least_forces_along(const struct Program *program, struct Values *values);
