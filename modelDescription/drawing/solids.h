/* Rigid bodies in space as uniform cylinders, disks and boxes of their mass and moments of inertia. */
#ifndef SOLIDS_H
#define SOLIDS_H

#include "model/model.h"
#include "shapes.h"

/* Two directions in space that the paper's axes show. */
struct View {
  double right[3], up[3];
};

struct Spot seen(const struct View *view, const double position[3]);

/* Whether it has a tensor of inertia, and so an extent in space. */
bool is_solid(const struct Body *body);

/* Nothing without mass and moments of inertia. */
void append_solid(struct Drawing *drawing, const struct View *view, const struct Model *model, const struct Body *body,
                  const double *values);

#endif
