/* Reads URDF, the Unified Robot Description Format, as far as it determines the motion: http://wiki.ros.org/urdf/XML */
#pragma once

#include <libxml/tree.h>

#include "base/diagnostics.h"
#include "robots/description/robot.h"
#include "robots/description/robot_options.h"

/* Names of the joint types, in the order of enum RobotJointType. */
extern const char *const joint_types[JOINT_TYPES];

/* Returns the links and joints of a <robot>, not yet connected. Reports errors and warns of elements not read. */
struct Robot *urdf_read(xmlNodePtr root, const struct RobotOptions *options, struct Diagnostics *diagnostics);
