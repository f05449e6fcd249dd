/* Validates documents against the schema fmu/system.xsd and reports violations in terms of the language. */
#pragma once

#include <stdio.h>

#include <libxml/tree.h>

#include "base/diagnostics.h"

/* The text of fmu/system.xsd, compiled into lagc. */
extern const char system_schema[];

/* Reports every violation of the schema. */
void schema_check(xmlDocPtr document, struct Diagnostics *diagnostics);

/* Prints a line "element NAME" for each element of the schema. */
void schema_print_elements(FILE *file);
