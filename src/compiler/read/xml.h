/* Loads and validates a system.xml with libxml2; its messages become ours. */
#ifndef XML_H
#define XML_H

#include <libxml/tree.h>

#include "diagnostics.h"

/* The text of fmu/system.xsd, built into the program. */
extern const char system_schema[];

/*
 * Reads the file and validates it against the schema, reporting every error. Returns NULL where the file cannot be
 * read or is not well-formed; a document that the schema refuses is returned, so that more errors can be found.
 */
xmlDocPtr xml_load(const char *path, struct Diagnostics *diagnostics);

#endif
