/* Loads and validates a system.xml with libxml2; its messages become ours. */
#pragma once

#include <libxml/tree.h>

#include "base/diagnostics.h"

/* Reads the file, whatever its elements are. NULL after reporting why it cannot be read. */
xmlDocPtr xml_read(const char *path, struct Diagnostics *diagnostics);

/*
 * Reads the file and holds it against the schema, unless it is that of a robot, reporting every mistake. NULL where there is one: what else it means for
 * names and expressions would hide it among messages that follow from it.
 */
xmlDocPtr xml_load(const char *path, struct Diagnostics *diagnostics);
