/*
 * A drawing of the system as it stands at its start values: particles, bodies as bars, frames, and lines between points whose
 * distance no coordinate changes.
 */
#ifndef SKETCH_H
#define SKETCH_H

#include "page.h"

/* Writes it as SVG; nothing where there is nothing to see. */
void write_sketch(const struct Page *page);

#endif
