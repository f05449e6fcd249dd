/* Robots as systems: what a URDF describes is written as the <system> that an author would write of it. */
#pragma once

#include <stdbool.h>

#include <libxml/tree.h>

#include "base/diagnostics.h"

/* What an <include> says of a robot beyond its file. */
struct RobotOptions {
  const char *base; /* "floating": the root link moves freely; "fixed" or NULL: it stands in the inertial frame */
  const char *
      tool; /* the link whose position and velocity are outputs; NULL: the only one without children, if there is one */
};

/*
 * Frees the document of a <robot>, and returns that of its <system>, which follows the schema, with the lines of the file.
 * NULL after reporting mistakes.
 */
xmlDocPtr system_of_robot(xmlDocPtr document, const struct RobotOptions *options, struct Diagnostics *diagnostics);
