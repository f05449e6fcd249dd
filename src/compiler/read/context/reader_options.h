/* Options of the command line for the reader. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct RobotOptions;

/* The options; zeros for none. */
struct ReaderOptions {
  const char *const *definitions; /* "name=value", replacing <constant> elements */
  size_t definition_count;
  const struct RobotOptions *robot; /* for the file of a robot; NULL for none */
  const char *solver;               /* method that replaces the system's own; NULL for none */
  const char *const *point;         /* "name=value" of the linearization point; may be empty */
  size_t point_count;
  bool pull;      /* add inputs for pulling bodies with the pointer, see pointer_interaction.h */
  bool linearize; /* linearize, even if point is empty */
};
