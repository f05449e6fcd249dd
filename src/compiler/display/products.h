/* Products as text: the number, then factors in natural order, then the denominator. */
#pragma once

#include "display/terms.h"

/* Returns the text, in parentheses unless it can be the base of a power: a name, a number or a function. */
char *fenced_base(const char *text);

/* Returns the text, in parentheses if it is a sum or begins with a sign. */
char *fenced_factor(const char *text);

/*
 * Returns a positive number times the powers of atoms of the term, whose coefficient is not used. texts has the texts
 * of the atoms; first is a further factor, a sum of parameters, or NULL.
 */
char *product_text(const struct Atoms *atoms, double number, const struct Term *term, const char *const *texts,
                   const char *first);

/* The order of atoms in products, by their kind: parameters first, accelerations last. */
enum FactorRank {
  RANK_PARAMETER_SUM,
  RANK_PARAMETER,
  RANK_MODE,
  RANK_INPUT,
  RANK_TIME,
  RANK_COORDINATE,
  RANK_STATE,
  RANK_VELOCITY,
  RANK_NAMED,
  RANK_FUNCTION,
  RANK_SUM,
  RANK_ACCELERATION
};

enum FactorRank factor_rank(const struct Atoms *atoms, Node atom);
