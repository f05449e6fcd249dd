/* Formulas, in the infix form of algebra/formula.h, as LaTeX: the one place with rules of typesetting. */
#pragma once

#include "model/model.h"

/*
 * Returns an expression as LaTeX; NULL if it is too long or nests too deeply. The page's script, mathml.js, reads what
 * this LaTeX may contain: letters, numbers, \frac, \sqrt, ^ and _. Parentheses may have \left and \right, as \left| has.
 * Further commands are cases, \dot, \ddot, \partial, \mathrm, \text, \operatorname, the common functions and \dots. Factors
 * have \, or \cdot between them, and the signs +, - and > stand between spaces.
 */
char *latex_of(const struct Model *model, const char *text);

/* Returns an equation as LaTeX; "" if it is too long. */
char *latex_of_equation(const struct Model *model, const char *left, const char *right);
