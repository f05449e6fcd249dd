/* What the command line says of how a file is read. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* What the command line adds to the file. */
struct ReaderOptions {
  const char *const *definitions; /* "name=value" for <constant> elements */
  size_t definition_count;
  const char *solver;       /* the method in place of the system's own; NULL for none */
  const char *const *point; /* "name=value" of a linearisation point; empty for none */
  size_t point_count;
  bool pull;      /* with inputs by which bodies can be pulled, see pulls.h */
  bool linearize; /* linearise at point even where it is empty */
};
