/* Tendons of robots: springs, dampers, friction, inertia and limits along a transmission, and what links two of them. */
#pragma once

#include "read/robots/description/robot.h"
#include "read/robots/robot_elements.h"

/* The length of a tendon as an output, and what acts along it. */
void write_tendon(const struct Writer *writer, const struct Tendon *tendon);

/* The constraint by which one tendon is as long as another says. */
void write_tendon_link(const struct Writer *writer, const struct Robot *robot, const struct TendonLink *link);
