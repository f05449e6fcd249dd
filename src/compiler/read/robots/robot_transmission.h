/* What pulls at several joints of a robot at once, or from site to site; and actuators, which push along it. */
#pragma once

#include "read/robots/description/robot.h"
#include "read/robots/robot_elements.h"

/* Whether its length is one, rather than an angle; and the unit of that. */
bool transmission_slides(const struct Transmission *transmission);
const char *transmission_unit(const struct Transmission *transmission);

/* Its length, and the rate of that, as expressions. */
char *transmission_length(const struct Transmission *transmission);
char *transmission_rate(const struct Transmission *transmission);

/*
 * What pushes its ends apart with a force times the gear: on joints, or on sites; the force has a name of its own, NAME_force, where
 * several rest on it. That of an actuator waits, at a joint that limits these, for write_limited_pushes().
 */
void write_pull(const struct Writer *writer, const struct Transmission *transmission, const char *gear,
                const char *name, char *force, bool is_of_actuator);

/* The input NAME_control of an actuator, and what it makes of it. */
void write_actuator(const struct Writer *writer, const struct Actuator *actuator);

/* What all actuators do to a joint that limits this. */
void write_limited_pushes(const struct Writer *writer, const struct Joint *joint);
