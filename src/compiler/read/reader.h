/* Reads system.xml into a model. */
#ifndef READER_H
#define READER_H

#include "base/diagnostics.h"
#include "model/model.h"

/* What the command line adds to the file. */
struct ReaderOptions {
  const char *const *definitions; /* "name=value" for <constant> elements */
  size_t definition_count;
  const char *solver;       /* the method in place of the system's own; NULL for none */
  const char *const *point; /* "name=value" of a linearisation point; empty for none */
  size_t point_count;
  bool linearize; /* linearise at point even where it is empty */
};

/*
 * Reads a system, or the system that a <linearization> names together with its point. Every error is reported;
 * returns NULL where there was any. Free with model_free().
 */
struct Model *model_read(const char *path, const struct ReaderOptions *options, struct Diagnostics *diagnostics);

#endif
