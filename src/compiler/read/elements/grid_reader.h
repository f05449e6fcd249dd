/* The lines of a table of two arguments: the knots of the first one, then those of the second with the values there. */
#pragma once

#include "read/context/attributes.h"
#include "read/tables/surface.h"

/* file: NULL where the text has the lines. False after reporting what is wrong. */
bool read_grid(struct Reader *reader, xmlNodePtr node, const char *name, const char *file, struct Surface *surface);
