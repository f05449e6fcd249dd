/* Where the things of a system are, and how large its constraints are, with its coordinates moved about: what links and surfaces are told by. */
#pragma once

#include "model/model.h"

/* What has a place: the base, a frame, a body, a particle or a point. */
struct Thing {
  const char *name;        /* NULL of the base */
  const struct Body *body; /* NULL of the base and frames */
  size_t frame;            /* that it is in, among the things */
  Node position[3];
  Node angle;     /* of a body in the plane */
  bool is_planar; /* such a body */
};

struct Samples {
  const struct Model *model;
  struct Thing *things; /* the first one is the base */
  size_t thing_count;
  size_t *constraints; /* among the model's: those of positions; none where there are very many */
  size_t constraint_count;
  double **values; /* of each sample, of each node up to the last one that these and the coordinates and gaps are */
  size_t count;
};

/*
 * is_still: time and inputs are those of the start, so that what they move stands still too. parameters: what is added to the start
 * value of each; NULL for nothing.
 */
struct Samples take_samples(const struct Model *model, bool is_still, const double *parameters);

/* There are many of large systems. */
void release_samples(struct Samples *samples);
