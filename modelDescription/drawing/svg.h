/* Writes a drawing as an SVG file. */
#pragma once

#include "picture_shapes.h"

/* Returns the content of the file, 128 x 128 pixels. */
char *svg_of(const struct Drawing *drawing);
