/*
 * Draws the system at its start values: particles, bodies as bars, cylinders or boxes, frames, rods and contact
 * surfaces. A system without visible objects is a block with its inputs and outputs.
 */
#ifndef SYSTEM_DRAWING_H
#define SYSTEM_DRAWING_H

#include "model/model.h"
#include "picture_shapes.h"

/* Returns the drawing, in pixels of a picture of PICTURE_SIZE. */
struct Drawing drawing_of(const struct Model *model);

#endif
