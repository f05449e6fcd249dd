/* Reads URDF, the robotics community's description of robots, as far as it tells of motion: http://wiki.ros.org/urdf/XML */
#pragma once

#include <libxml/tree.h>

#include "base/diagnostics.h"
#include "read/robots/description/robot.h"

/* The joint types by name, in the order of enum JointType. */
extern const char *const joint_types[JOINT_TYPES];

/* Links and joints of a <robot>, not yet connected. Every mistake is reported, and what is left out told once. */
struct Robot *urdf_read(xmlNodePtr root, const struct RobotOptions *options, struct Diagnostics *diagnostics);
