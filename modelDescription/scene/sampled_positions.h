/*
 * Samples of a system: positions of its objects and values of its constraints in several configurations, from which
 * links and surfaces are recognized.
 */
#pragma once

#include "model/model.h"

/* An object with a position: the base, a frame, a body, a particle or a point. */
struct SceneObject {
  const char *name;        /* NULL for the base */
  const struct Body *body; /* NULL for the base and frames */
  size_t frame;            /* index of the object that it is in */
  Node position[3];
  Node angle;     /* of a planar body */
  bool is_planar; /* it is a planar body */
};

/* Samples of one model. values[0] is the start. Indices of objects refer to objects[]. */
struct SampledPositions {
  const struct Model *model;
  struct SceneObject *objects; /* the first one is the base */
  size_t object_count;
  size_t *constraints; /* indices in the model, of constraints on positions; none if there are too many */
  size_t constraint_count;
  /* of each sample: values by node, up to the last node of positions, constraints, coordinates and gaps */
  double **values;
  size_t count;
};

/*
 * Takes the samples; the first one is the start. is_still: time and inputs keep their start values. parameters:
 * changes of the start values of all parameters; NULL for none.
 */
struct SampledPositions sample_positions(const struct Model *model, bool is_still, const double *parameters);

/* Frees the values, which take much memory for large systems. */
void release_positions(struct SampledPositions *samples);
