/* The picture of a mechanical flange, by which diagrams show where a terminal is connected. */
#ifndef FLANGE_DRAWING_H
#define FLANGE_DRAWING_H

#include "shapes.h"

/* A disk that fills the picture, in pixels of one of PICTURE_SIZE. */
struct Drawing flange_drawing(void);

#endif
