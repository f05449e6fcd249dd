/* <include> of MJCF: what is in other files stands in its place. */
#pragma once

#include <libxml/tree.h>

#include "base/diagnostics.h"

/*
 * Replaces each <include> by the elements in its file, which is looked for beside the robot's file, then beside the one with the
 * <include>. Messages about these elements name the line of the robot's <include>. Reports files that cannot be read, or come twice.
 */
void mjcf_insert_files(xmlNodePtr root, struct Diagnostics *diagnostics);
