/*
 * Names as a book would print them: theta1, theta[1] and omegaCoupler are Greek letters with an index, x_end has one too, the
 * part of a system that a name belongs to is a further index, and loop.force is F with the constraint's name.
 */
#ifndef LETTERS_H
#define LETTERS_H

#include <stdio.h>

/* Writes the name as MathML, with 0, 1 or 2 dots on it for derivatives by time. */
void letters_write(FILE *file, const char *name, int dots);

/* About how wide it is, in letters. */
double letters_width(const char *name);

#endif
