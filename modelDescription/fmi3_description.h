/* Writes the files of an FMU of FMI 3.0 that describe it (sections 2.4 and 2.5). Each appends to buffer and returns false
 * where libxml2 reports an error. */
#pragma once

#include <libxml/tree.h>

#include "program/program.h"

/* modelDescription.xml */
bool fmi3_description_write(xmlBufferPtr buffer, const struct Program *program, const char *token);

/* sources/buildDescription.xml, of an FMU that is complete in C. */
bool fmi3_build_description_write(xmlBufferPtr buffer, const struct Program *program);

/* How many coordinates are terminals: those with one input that is the force along them. */
size_t fmi3_terminal_count(const struct Program *program);

/* terminalsAndIcons/terminalsAndIcons.xml, whose terminals are drawn by flange.png and flange.svg. */
bool fmi3_terminals_write(xmlBufferPtr buffer, const struct Program *program);
