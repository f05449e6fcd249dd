/* Converts robots, in URDF or MJCF, to the <system> that an author would write. */
#pragma once

#include <libxml/tree.h>

#include "base/diagnostics.h"
#include "robots/description/robot_options.h"

/*
 * Frees the document of a robot and returns that of its <system>, valid by the schema, with the lines of the robot
 * file. Returns NULL after reporting errors.
 */
xmlDocPtr system_of_robot(xmlDocPtr document, const struct RobotOptions *options, struct Diagnostics *diagnostics);
