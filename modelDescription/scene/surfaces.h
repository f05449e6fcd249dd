/* Finds the surfaces that objects hit: planes of contacts, and stops of coordinates. */
#pragma once

#include "sampled_positions.h"

/* A plane that an object hits. The normal has length 1. */
struct SceneSurface {
  size_t object;    /* index of the object that hits it */
  double point[3];  /* m: in the plane; of a stop: the position of the object at the stop */
  double normal[3]; /* unit vector towards the open side */
  bool is_stop;
};

struct Surfaces {
  struct SceneSurface *items;
  size_t count;
};

/* Returns at most one surface for each contact. */
struct Surfaces find_surfaces(const struct SampledPositions *samples);
