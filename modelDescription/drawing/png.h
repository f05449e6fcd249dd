/* Converts a drawing to PNG, 128 x 128 pixels on white. */
#ifndef PNG_H
#define PNG_H

#include "picture_shapes.h"

/* Returns the bytes of the file, and their number in *length. */
unsigned char *png_of(const struct Drawing *drawing, size_t *length);

#endif
