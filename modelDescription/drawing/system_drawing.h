/*
 * A drawing of the system as it stands at its start: particles, bodies as bars, cylinders or boxes, frames, rods and what contacts push
 * against. Where nothing of it can be seen, a block with its inputs and outputs.
 */
#ifndef SYSTEM_DRAWING_H
#define SYSTEM_DRAWING_H

#include "model/model.h"
#include "shapes.h"

/* In pixels of a picture of PICTURE_SIZE. */
struct Drawing drawing_of(const struct Model *model);

#endif
