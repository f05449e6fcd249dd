/* Writes the sections on energies, constraints, equations of motion and forces, of a system with coordinates. */
#ifndef MECHANICS_SECTIONS_H
#define MECHANICS_SECTIONS_H

#include "page.h"

void write_mechanics(struct Page *page);

#endif
