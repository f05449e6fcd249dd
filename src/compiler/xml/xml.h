/*
 * Loads XML files with libxml2 and validates those of systems. Messages of libxml2 are replaced by messages for the
 * author of the file.
 */
#pragma once

#include <libxml/tree.h>

#include "base/diagnostics.h"

/* Parses the file without validation. Returns NULL after reporting an error. The caller frees the document. */
xmlDocPtr xml_read(const char *path, struct Diagnostics *diagnostics);

/*
 * Reads the file and validates it against the schema, unless it describes a robot. Returns NULL after reporting errors.
 * Later passes read valid documents only, so that no error causes further ones.
 */
xmlDocPtr xml_load(const char *path, struct Diagnostics *diagnostics);
