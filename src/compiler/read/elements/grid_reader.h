/*
 * Reads tables of two arguments. A line has the knots of the first argument; then a line for each knot of the
 * second argument has the values there.
 */
#pragma once

#include "read/context/attributes.h"
#include "read/tables/surface.h"

/* Reads the lines of a file, or of the element's text if file is NULL. Returns false after reporting an error. */
bool read_grid(struct Reader *reader, xmlNodePtr node, const char *name, const char *file,
               struct SurfaceTable *surface);
