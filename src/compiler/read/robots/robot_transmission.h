/* What pulls at several joints of a robot at once: tendons, and actuators. */
#pragma once

#include "read/robots/description/robot.h"
#include "read/robots/robot_elements.h"

/* The length of a tendon as an output, and what acts along it. */
void write_tendon(const struct Writer *writer, const struct Tendon *tendon);

/* The input NAME_control of an actuator, and what it makes of it. */
void write_actuator(const struct Writer *writer, const struct Actuator *actuator);
