/* Draws rigid bodies in space as uniform cylinders or boxes with the same mass and moments of inertia. */
#ifndef SOLIDS_H
#define SOLIDS_H

#include "model/model.h"
#include "picture_shapes.h"

/* A parallel projection: the directions in space along the axes of the picture, of length 1. */
struct View {
  double right[3], up[3];
};

/* Returns the projection of a position. */
struct PicturePoint projected(const struct View *view, const double position[3]);

/* True if the body has an inertia tensor, and so an extent in space. */
bool is_solid(const struct Body *body);

/* Appends a body; nothing if its mass or inertia vanishes. values: of all nodes. */
void append_solid(struct Drawing *drawing, const struct View *view, const struct Model *model, const struct Body *body,
                  const double *values);

/* A form that is drawn: its centre, the directions of its axes, and half of its size along each, in m. */
struct Solid {
  double middle[3], axis[3][3], half[3];
};

/* Append a box, an ellipsoid, or a cylinder about one of its axes. */
void append_box(struct Drawing *drawing, const struct View *view, const struct Solid *solid);
void append_ellipsoid(struct Drawing *drawing, const struct View *view, const struct Solid *solid);
void append_cylinder(struct Drawing *drawing, const struct View *view, const struct Solid *solid, int axis);

#endif
