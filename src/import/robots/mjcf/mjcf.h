/*
 * Reads MJCF, MuJoCo's format for robots, as far as it determines the motion:
 * https://mujoco.readthedocs.io/en/stable/XMLreference.html
 */
#pragma once

#include <libxml/tree.h>

#include "base/diagnostics.h"
#include "robots/description/robot.h"
#include "robots/description/robot_options.h"

/*
 * Returns the bodies of a <mujoco> as links, with joints, not yet connected; "world" is the root. Reports every error,
 * and every part that would change the motion but is not supported. Warns once of parts that are left out.
 */
struct Robot *mjcf_read(xmlNodePtr root, const struct RobotOptions *options, struct Diagnostics *diagnostics);
