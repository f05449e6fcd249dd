/* Reads MJCF, MuJoCo's description of robots, as far as it tells of motion: https://mujoco.readthedocs.io/en/stable/XMLreference.html */
#pragma once

#include <libxml/tree.h>

#include "base/diagnostics.h"
#include "read/robots/description/robot.h"

/*
 * Bodies as links, and joints, of a <mujoco>, not yet connected; "world" is the root. Every mistake, and what would change the motion
 * but is not known, is reported; what is left out is told once.
 */
struct Robot *mjcf_read(xmlNodePtr root, const struct RobotOptions *options, struct Diagnostics *diagnostics);
