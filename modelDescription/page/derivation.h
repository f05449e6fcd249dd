/*
 * The derivation of the equations of motion step by step, as in fmu/theory/01-equations-of-motion.md: folded on the
 * page, and for systems of few coordinates.
 */
#ifndef DERIVATION_H
#define DERIVATION_H

#include "page.h"

void write_derivation(struct Page *page);

#endif
