/* <attach> of MJCF: inserts bodies of other files. */
#pragma once

#include <stddef.h>

#include <libxml/tree.h>

#include "base/diagnostics.h"

/* Attribute of a <compiler>: the path of its attached file, relative to the robot's file. */
extern const char mjcf_file_note[];

/*
 * Replaces each <attach> in the tree by a <frame> with the body of its file, and adds the sections that belong to it.
 * All names and classes of it have the prefix. Replaces its <include>, <attach> and <replicate> first. Returns the
 * number of attached files. Reports missing files, models and names.
 */
size_t mjcf_attach(xmlNodePtr root, struct Diagnostics *diagnostics);

/*
 * Returns the number of the file that an element belongs to: 0 for the robot's file and those that it includes, from 1
 * on for attached ones.
 */
size_t mjcf_model_of(const xmlNode *node);
