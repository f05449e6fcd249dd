/* Converts tendons: elements along a transmission, and constraints between two tendons or joints. */
#pragma once

#include "robots/description/robot.h"
#include "robots/robot_elements.h"

/* Writes the length of a tendon as an output, and the elements that act along it. */
void write_tendon(const struct Writer *writer, const struct Tendon *tendon);

/* Writes the constraint that makes a tendon's length or a joint's position a function of another's. */
void write_coupling(const struct Writer *writer, const struct Coupling *coupling);
