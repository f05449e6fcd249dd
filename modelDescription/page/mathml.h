/* Formulas as MathML, which browsers typeset without a library. */
#ifndef MATHML_H
#define MATHML_H

/*
 * Returns "left = right", in the infix form of algebra/formula.h, as several <math> elements between which browsers
 * may break the line: before terms of sums, and between factors if they are too wide for a narrow page. Returns NULL
 * if the text is not of this form or exceeds LENGTH_LIMIT.
 */
char *mathml_of_equation(const char *equation);

/* Returns the name of a variable, or der() of one, in the same form. */
char *mathml_of_name(const char *name);

#endif
