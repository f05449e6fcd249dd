/* What things hit: planes of contacts, and stops of coordinates. */
#pragma once

#include "samples.h"

struct Surface {
  size_t thing;     /* among the samples', that hits it */
  double point[3];  /* m: in the plane; of a stop, where the thing is when it hits */
  double normal[3]; /* of length 1, towards where the gap is open */
  bool is_stop;
};

struct Surfaces {
  struct Surface *items;
  size_t count;
};

struct Surfaces find_surfaces(const struct Samples *samples);
