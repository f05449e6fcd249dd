/* Draws the shapes of <shape>, except meshes. */
#ifndef SHAPE_DRAWING_H
#define SHAPE_DRAWING_H

#include "model/model.h"
#include "solids.h"

/* True if some shape of this kind belongs to the body, or to its frame. */
bool has_drawn_shape(const struct Model *model, const struct Body *body);

/* Appends a shape. values: of all nodes of the model. */
void append_drawn_shape(struct Drawing *drawing, const struct View *view, const struct Model *model,
                        const struct ContactShape *shape, const double *values);

/* True for a plane that is drawn; sets a point of it, in m, and its normal. */
bool find_drawn_plane(const struct Model *model, const struct ContactShape *shape, const double *values,
                      double point[3], double normal[3]);

#endif
