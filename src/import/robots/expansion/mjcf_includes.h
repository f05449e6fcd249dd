/* <include> of MJCF: inserts the content of other files. */
#pragma once

#include <libxml/tree.h>

#include "base/diagnostics.h"

/*
 * Replaces each <include> by the elements in its file. The path is relative to the robot's file, or else to the file
 * with the <include>. Messages about these elements name their own file if lines are noted, else the line of the
 * <include>. Reports files that cannot be read or are included twice.
 */
void mjcf_insert_files(xmlNodePtr root, struct Diagnostics *diagnostics);
