/* A drawing as PNG, of 128 pixels a side on white paper. */
#ifndef PNG_H
#define PNG_H

#include "shapes.h"

/* The bytes of the file; *length becomes their number. */
unsigned char *png_of(const struct Drawing *drawing, size_t *length);

#endif
