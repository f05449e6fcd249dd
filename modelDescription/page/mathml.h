/* Formulas as MathML, which browsers typeset without a network. */
#ifndef MATHML_H
#define MATHML_H

/*
 * "left = right" in the infix form of algebra/formula.h as several <math> elements, between which a browser may break the
 * line: before the terms of sums and between factors, where they are too wide for a narrow page.
 * NULL where the text is none of this form, or longer than anybody reads.
 */
char *mathml_of_equation(const char *equation);

/* The name of a variable, or der() of one, in the same way. */
char *mathml_of_name(const char *name);

#endif
