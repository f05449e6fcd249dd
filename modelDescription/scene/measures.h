/* Coordinates and lengths that a drawing shows, with their names. */
#pragma once

#include "start_scene.h"

/* The change of a coordinate in the drawing. In a rotation, from is the centre, and to a point that rotates. */
struct CoordinateMark {
  const char *name;
  double from[3], to[3]; /* m; of a translation: at 0 and at the start value */
  double along[3];       /* unit vector of the translation, or of the axis of the rotation */
  bool is_rotation;
  double start; /* m or rad */
};

struct Measures {
  struct CoordinateMark *marks;
  size_t mark_count;
  const char **lengths; /* for each line of the model: the parameter that is its length; NULL for none */
};

/* Finds the measures of a scene. */
struct Measures find_measures(const struct StartScene *scene);
