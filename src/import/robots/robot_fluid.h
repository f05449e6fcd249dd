/* The forces of a fluid around a robot. */
#pragma once

#include "robots/robot_elements.h"

/* Writes the parameters of the wind. */
void write_wind(const struct Writer *writer, const struct Robot *robot);

/* Writes the force and torque of the fluid on a link. The elements of the link come before. */
void write_fluid_forces(struct Writer *writer, const struct Robot *robot, const struct RobotLink *link);
