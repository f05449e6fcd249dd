/*
 * The files that lagc leaves: all of them, or none. They are written beside those of an earlier run and then renamed;
 * wherever lagc is stopped, system.c is there only with the others of its run.
 */
#pragma once

#include "base/diagnostics.h"
#include "interface/summary.h"
#include "program/program.h"

/*
 * Writes system.c, modelDescription.xml and documentation/index.html into the directory, which is created where it
 * is missing, or reports why that fails.
 */
void output_write(const struct Program *program, const struct Summary *summary, const char *directory,
                  struct Diagnostics *diagnostics);

/* Removes these files, also those of an earlier run: after an error none is left. */
void output_remove(const char *directory);
