/* Transmissions, whose length depends on several joints or on sites: forces along them, and actuators. */
#pragma once

#include "robots/description/robot.h"
#include "robots/robot_elements.h"

/* Return whether the transmission's length is a length rather than an angle, and its unit. */
bool transmission_slides(const struct Transmission *transmission);
const char *transmission_unit(const struct Transmission *transmission);

/* Return expressions of the length and of its rate. */
char *transmission_length(const struct Transmission *transmission);
char *transmission_rate(const struct Transmission *transmission);

/*
 * Writes a force times the gear along the transmission, positive if it lengthens it: on joints, or between sites. A
 * force that is used several times becomes the definition NAME_force. Forces of actuators on joints that limit them are
 * left to write_limited_forces().
 */
void write_term(const struct Writer *writer, const struct Transmission *transmission, const char *gear,
                const char *name, char *force, bool is_of_actuator);

/* Writes the input NAME_control of an actuator, and its force. */
void write_actuator(const struct Writer *writer, const struct Actuator *actuator);

/* Writes the sum of the actuators' forces on a joint that limits it. */
void write_limited_forces(const struct Writer *writer, const struct RobotJoint *joint);
