/*
 * Line breaking. Browsers do not break inside <math>, so that a wide formula becomes several <math> elements with
 * <wbr/> between them. A subformula up to `narrow` letters wide is set as a whole (typeset.c); a wider one is split at
 * its operator, and its operands recursively. Wide fractions and powers are rewritten on one line, as a <math> element
 * cannot contain a break. Each node is visited once.
 */
#include "mathml.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "formula_tree.h"
#include "typeset.h"

#define MATH "<math display=\"inline\" displaystyle=\"true\">"

/* Width in letters up to which a formula is not broken: it fits on a phone. */
static const double narrow = 20.0;

/* The same for cases, which are not broken as a formula: they would become if(c, a, b). */
static const double narrow_cases = 28.0;

/* Length in characters above which an equation is shown as text only. */
enum { LENGTH_LIMIT = 3000 };

static void write_in_pieces(FILE *file, const struct Formula *formula);

static void allow_break(FILE *file) {
  fputs("</math><wbr/>" MATH, file);
}

static void write_fenced_in_pieces(FILE *file, const struct Formula *formula, bool is_fenced) {
  if (is_fenced) typeset_parenthesis(file, "(", formula->is_tall);
  write_in_pieces(file, formula);
  if (is_fenced) typeset_parenthesis(file, ")", formula->is_tall);
}

static void write_sum_in_pieces(FILE *file, const struct Formula *formula) {
  for (size_t i = 0; i < formula->count; i++) {
    const struct Formula *term = formula->parts[i];
    if (i > 0) allow_break(file);
    typeset_sign(file, &term, i == 0);
    write_fenced_in_pieces(file, term, !stands_as_factor(term));
  }
}

static void write_product_in_pieces(FILE *file, const struct Formula *formula) {
  double width = 0.0; /* of the present <math> element */
  for (size_t i = 0; i < formula->count; i++) {
    const struct Formula *factor = formula->parts[i];
    if (i > 0) typeset_times(file, factor);
    if (i > 0 && width + factor->width > narrow) {
      allow_break(file);
      width = 0.0;
    }
    width += factor->width;
    if (factor->width <= (is_choice(factor) ? narrow_cases : narrow)) typeset_factor(file, formula, i);
    else write_fenced_in_pieces(file, factor, !stands_as_factor(factor));
  }
}

/* Writes a wide numerator after the fraction, a wide denominator after a slash. */
static void write_fraction_in_pieces(FILE *file, const struct Formula *formula) {
  const struct Formula *above = formula->parts[0], *below = formula->parts[1];
  if (below->width <= narrow) {
    fputs("<mfrac><mn>1</mn><mrow>", file);
    typeset(file, below);
    fputs("</mrow></mfrac>", file);
    typeset_times(file, above);
    if (below->kind != NUMBER) allow_break(file);
    write_fenced_in_pieces(file, above, !stands_as_factor(above));
  } else {
    write_fenced_in_pieces(file, above, !stands_as_factor(above));
    allow_break(file);
    fputs("<mo form=\"infix\">/</mo>", file);
    write_fenced_in_pieces(file, below, !stands_as_base(below));
  }
}

static void write_application_in_pieces(FILE *file, const char *function, const struct Formula *formula) {
  typeset_function(file, function);
  typeset_parenthesis(file, "(", formula->is_tall);
  for (size_t i = 0; i < formula->count; i++) {
    if (i > 0) {
      fputs("<mo>,</mo>", file);
      allow_break(file);
    }
    write_in_pieces(file, formula->parts[i]);
  }
  typeset_parenthesis(file, ")", formula->is_tall);
}

static void write_raised_in_pieces(FILE *file, const struct Formula *formula) {
  if (formula->parts[1]->width > narrow / 2.0) {
    write_application_in_pieces(file, "pow", formula);
    return;
  }
  bool is_tall = formula->parts[0]->is_tall;
  typeset_parenthesis(file, "(", is_tall);
  write_in_pieces(file, formula->parts[0]);
  fputs("<msup>", file);
  typeset_parenthesis(file, ")", is_tall);
  fputs("<mrow>", file);
  typeset(file, formula->parts[1]);
  fputs("</mrow></msup>", file);
}

/* Writes a long name in parts. */
static void write_name_in_pieces(FILE *file, const char *name) {
  size_t length = strlen(name), most = (size_t)narrow;
  for (size_t i = 0; i < length; i += most) {
    if (i > 0) allow_break(file);
    fprintf(file, "<mi>%.*s</mi>", (int)(length - i < most ? length - i : most), name + i);
  }
}

static void write_in_pieces(FILE *file, const struct Formula *formula) {
  const struct Formula *inside = formula;
  if (formula->width <= (is_choice(formula) ? narrow_cases : narrow)) {
    typeset(file, formula);
    return;
  }
  switch (formula->kind) {
  case NUMBER:
  case ELLIPSIS: typeset(file, formula); break;
  case NAME: write_name_in_pieces(file, formula->word); break;
  case APPLICATION: write_application_in_pieces(file, formula->word, formula); break;
  case CONDITION:
    write_in_pieces(file, formula->parts[0]);
    fputs("<mo>&gt;</mo>", file);
    write_in_pieces(file, formula->parts[1]);
    break;
  case SUM: write_sum_in_pieces(file, formula); break;
  case NEGATIVE:
    typeset_sign(file, &inside, true);
    write_fenced_in_pieces(file, inside, !stands_as_factor(inside));
    break;
  case PRODUCT: write_product_in_pieces(file, formula); break;
  case FRACTION: write_fraction_in_pieces(file, formula); break;
  case RAISED: write_raised_in_pieces(file, formula); break;
  }
}

char *mathml_of_equation(const char *equation) {
  struct Formula *sides[2];
  if (strlen(equation) > LENGTH_LIMIT || !formula_read(equation, sides)) return NULL;
  struct TextStream text;
  FILE *file = open_text(&text);
  fputs(MATH, file);
  write_in_pieces(file, sides[0]);
  allow_break(file);
  fputs("<mo form=\"infix\">=</mo>", file);
  write_in_pieces(file, sides[1]);
  fputs("</math>", file);
  return close_text(&text);
}

char *mathml_of_name(const char *name) {
  struct Formula *formula = formula_of_name(name);
  struct TextStream text;
  FILE *file = open_text(&text);
  fputs(MATH, file);
  write_in_pieces(file, formula);
  fputs("</math>", file);
  return close_text(&text);
}
