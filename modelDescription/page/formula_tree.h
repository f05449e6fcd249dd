/* Parses a formula in the infix form of algebra/formula.h into a tree with estimated widths. */
#ifndef FORMULA_TREE_H
#define FORMULA_TREE_H

#include <stdbool.h>
#include <stddef.h>

enum FormulaKind { NUMBER, NAME, ELLIPSIS, APPLICATION, CONDITION, SUM, NEGATIVE, PRODUCT, FRACTION, RAISED };

/* A node of a formula. Sums and products have two parts or more, negatives one, fractions and powers two. */
struct Formula {
  enum FormulaKind kind;
  char *word; /* the number, the name, or the name of the function */
  struct Formula **parts;
  size_t count;
  double width; /* estimated, in letters */
  bool is_tall; /* contains a fraction or cases */
};

/* Parses both sides of "left = right". Returns false if the text is not of this form. */
bool formula_read(const char *equation, struct Formula *sides[2]);

/* True for if(condition, value, other). */
bool is_choice(const struct Formula *formula);

/* Parses a name, or the derivative of one. */
struct Formula *formula_of_name(const char *name);

#endif
