/* The files that lagc leaves: all of them, or none. */
#ifndef OUTPUT_H
#define OUTPUT_H

#include "diagnostics.h"
#include "program.h"

/*
 * Writes system.c, modelDescription.xml and documentation/index.html into the directory, which is created where it
 * is missing. On an error, which is reported, no file is left.
 */
void output_write(const struct Program *program, const char *directory, struct Diagnostics *diagnostics);

#endif
