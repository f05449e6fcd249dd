/*
 * A system in space as it stands at its start, in parallel projection from above and aside: its frames, with lines to what
 * is in them, bodies, particles and points, and the way that the last of these goes.
 */
#ifndef SKETCH_H
#define SKETCH_H

#include <cairo.h>

#include "library.h"
#include "scene.h"

/* Draws into a square picture. False where the FMU does not tell where things are. */
bool sketch(cairo_t *cairo, int size, const struct Library *fmu, fmi2Component c, const struct Description *description,
            const struct Scene *scene);

#endif
