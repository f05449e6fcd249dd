/* Robots as systems: what a URDF describes is written as the <system> that an author would write of it. */
#pragma once

#include <libxml/tree.h>

#include "base/diagnostics.h"
#include "read/robots/description/robot.h"

/*
 * Frees the document of a <robot>, and returns that of its <system>, which follows the schema, with the lines of the file.
 * NULL after reporting mistakes.
 */
xmlDocPtr system_of_robot(xmlDocPtr document, const struct RobotOptions *options, struct Diagnostics *diagnostics);
