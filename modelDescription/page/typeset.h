/* A formula as MathML in one piece, and what it is put together from. */
#ifndef TYPESET_H
#define TYPESET_H

#include <stdio.h>

#include "formula_tree.h"

/* Writes what stands inside a <math> element. */
void typeset(FILE *file, const struct Formula *formula);

/* Factor i of a product, without the sign before it. */
void typeset_factor(FILE *file, const struct Formula *product, size_t i);

/* Between two factors: a thin space, or a dot where numbers would run together. */
void typeset_times(FILE *file, const struct Formula *next);

/* The sign before a term; *term becomes what follows it. */
void typeset_sign(FILE *file, const struct Formula **term, bool first);

/* A parenthesis around what is as tall, of which one may stand in another piece. */
void typeset_parenthesis(FILE *file, const char *parenthesis, bool is_tall);

void typeset_function(FILE *file, const char *function);

/* Whether a formula needs no parentheses as a factor or a term; and as the base of a power. */
bool stands_as_factor(const struct Formula *formula);
bool stands_as_base(const struct Formula *formula);

#endif
