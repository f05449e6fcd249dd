/* Files of MJCF whose elements are copied into another one. */
#pragma once

#include <libxml/tree.h>

#include "base/diagnostics.h"

/* Depth of files that name each other; it bounds the depth of the resulting tree. */
enum { MJCF_DEPTH_LIMIT = 8 };

/* Makes messages name another file and origin; returns the ones before. The lines are not used. */
struct FileLine mjcf_switch_file(struct Diagnostics *diagnostics, struct FileLine place);

/* Parses a file. Messages name it by this place. Returns NULL after reporting an error. */
xmlDocPtr mjcf_load(struct Diagnostics *diagnostics, struct FileLine place);

/*
 * Returns a copy of a node for another document or place. The copies have the lines of the originals, in the file of
 * these messages. If lines are not noted, they have that of the element that names the file.
 */
xmlNodePtr mjcf_copy(const struct Diagnostics *of_file, long line, xmlNodePtr node, xmlDocPtr document);

/* Returns a copy of an element in the same file. */
xmlNodePtr mjcf_copy_within(xmlNodePtr node);
