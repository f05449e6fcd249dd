/* Formulas as MathML, which browsers typeset without a network. */
#pragma once

/*
 * "left = right" in the infix form of algebra/formula.h as <math> elements, one for each term of the right side, between
 * which a browser may break the line. NULL where the text is none of this form.
 */
char *mathml_of_equation(const char *text);
