/* Holds a file against the schema of system.xml, in words of its author; fmu/system.xsd says what may stand where. */
#pragma once

#include <stdio.h>

#include <libxml/tree.h>

#include "base/diagnostics.h"

/* The text of fmu/system.xsd, built into the program. */
extern const char system_schema[];

/* Reports each place where the document does not follow the schema. */
void schema_check(xmlDocPtr document, struct Diagnostics *diagnostics);

/* A line "element NAME" for each element of the schema. */
void schema_print_elements(FILE *file);
