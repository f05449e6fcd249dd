/*
 * Typesets names as in print: theta1, theta[1] and omegaCoupler as Greek letters with an index, x_end also with an
 * index. The part of the system that a name belongs to is a further index, and loop.force is F with the constraint's
 * name.
 */
#ifndef GLYPHS_H
#define GLYPHS_H

#include <stdio.h>

/* Writes the name as MathML, with 0, 1 or 2 dots for time derivatives. */
void glyphs_write(FILE *file, const char *name, int dots);

/* Returns the estimated width in letters. */
double glyphs_width(const char *name);

#endif
