/*
 * The output files of lagc: all of them, or none. They are written beside those of an earlier run and then renamed.
 * Wherever lagc is stopped, system.c exists only together with the other files of its run.
 */
#pragma once

#include "base/diagnostics.h"
#include "interface/summary.h"
#include "program/program.h"

/* Writes all files into the directory, which is created if missing. Reports an error if that fails. */
void output_write(const struct Program *program, const struct Summary *summary, const char *directory,
                  struct Diagnostics *diagnostics);

/* Removes these files, including those of an earlier run, so that an error leaves none. */
void output_remove(const char *directory);
