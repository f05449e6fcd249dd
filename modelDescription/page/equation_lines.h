/* The sections with equations: on the page, and as lines with tabs, which the command `lagrange-fmu show` reads. */
#ifndef EQUATION_LINES_H
#define EQUATION_LINES_H

#include "page.h"

/* Writes the sections in their order. */
void write_equations(struct Page *page);

/*
 * Prints lines whose first word is the kind, and whose fields are separated by tabs:
 *
 *  system       name, description, version of lagc
 *  parameter    name, unit, start value, description; likewise input, coordinate, velocity and state
 *  multiplier   name of a constraint's force, name of the constraint
 *  contact      name of its constraint, name of the mode that is 1 while it is closed; likewise friction, and its mode
 *  heading, text, step      text
 *  equation     label, left side, right side, and the equation in LaTeX, which is empty if it is long
 *  line         the same without a label, for an equation of the derivation; "..." is a long right side
 */
void equations_print(FILE *file, const struct Model *model, const struct Equations *equations,
                     const struct Summary *summary);

#endif
