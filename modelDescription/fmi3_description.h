/*
 * Writes the description files of an FMU of FMI 3.0 (sections 2.4 and 2.5). Each function appends to buffer, and
 * returns false if libxml2 reports an error.
 */
#pragma once

#include <libxml/tree.h>

#include "program/program.h"

/* Writes modelDescription.xml. */
bool fmi3_description_write(xmlBufferPtr buffer, const struct Program *program, const char *token);

/* Writes sources/buildDescription.xml, of an FMU whose sources are complete. */
bool fmi3_build_description_write(xmlBufferPtr buffer, const struct Program *program);

/* Returns the number of terminals: coordinates in m or rad with exactly one input as force along them. */
size_t fmi3_terminal_count(const struct Program *program);

/* Writes terminalsAndIcons/terminalsAndIcons.xml. flange.png and flange.svg show the terminals. */
bool fmi3_terminals_write(xmlBufferPtr buffer, const struct Program *program);
