/* The height at which a floating base starts on the ground. */
#pragma once

#include "base/diagnostics.h"
#include "robots/description/robot.h"
#include "robots/description/robot_options.h"

/*
 * Returns the start of a floating base along z, in m, at which its lowest shape stands on the ground, the plane z = 0. It
 * is rounded up to 0.1 mm; 0 for a fixed base. Starts in the <include> count if they are expressions of numbers. Notes
 * the height unless the <include> gives one. Warns of links below the ground by that, or on a fixed base.
 */
double robot_start_height(const struct Robot *robot, const struct RobotOptions *options,
                          const struct Diagnostics *diagnostics);

/* Returns the start value that an <include> gives a coordinate; NULL for none. */
char *robot_own_start(const struct RobotOptions *options, const char *coordinate);
