/* A formula in the infix form of algebra/formula.h as a tree, which knows about how wide it is when it is typeset. */
#ifndef FORMULA_TREE_H
#define FORMULA_TREE_H

#include <stdbool.h>
#include <stddef.h>

enum FormulaKind { NUMBER, NAME, ELLIPSIS, APPLICATION, CONDITION, SUM, NEGATIVE, PRODUCT, FRACTION, RAISED };

struct Formula {
  enum FormulaKind kind;
  char *word; /* the number, the name, or the function that is applied */
  struct Formula **parts;
  size_t count;
  double width; /* in letters */
  bool is_tall; /* has a fraction in it */
};

/* The left and the right side of "left = right"; false, and nothing to free, where the text is none of this form. */
bool formula_read(const char *equation, struct Formula *sides[2]);

/* A name, or the derivative of one. */
struct Formula *formula_of_name(const char *name);

#endif
