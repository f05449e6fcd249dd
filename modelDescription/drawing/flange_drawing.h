/* The symbol of a mechanical flange, which diagrams show at a terminal. */
#ifndef FLANGE_DRAWING_H
#define FLANGE_DRAWING_H

#include "picture_shapes.h"

/* Returns a disk that fills a picture of PICTURE_SIZE, in pixels. */
struct Drawing flange_drawing(void);

#endif
