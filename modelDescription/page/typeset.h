/* Typesets a formula as MathML in one piece; mathml.c combines the pieces. */
#ifndef TYPESET_H
#define TYPESET_H

#include <stdio.h>

#include "formula_tree.h"

/* Writes the content of a <math> element. */
void typeset(FILE *file, const struct Formula *formula);

/* Writes factor i of a product, without the operator before it. */
void typeset_factor(FILE *file, const struct Formula *product, size_t i);

/* Writes the operator between two factors: a thin space, or a dot before a number. */
void typeset_times(FILE *file, const struct Formula *next);

/* Writes the sign before a term; *term becomes the term without its sign. */
void typeset_sign(FILE *file, const struct Formula **term, bool first);

/* Writes a parenthesis with a fixed height, as its counterpart may be in another <math> element. */
void typeset_parenthesis(FILE *file, const char *parenthesis, bool is_tall);

/* Typesets the name of a function, upright. */
void typeset_function(FILE *file, const char *function);

/* True if a formula needs no parentheses as a factor or term, and as the base of a power. */
bool stands_as_factor(const struct Formula *formula);
bool stands_as_base(const struct Formula *formula);

#endif
