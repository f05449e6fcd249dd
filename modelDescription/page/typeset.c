#include "typeset.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "glyphs.h"

static bool is_one_of(const char *word, const char *const *words) {
  for (size_t i = 0; words[i] != NULL; i++)
    if (strcmp(word, words[i]) == 0) return true;
  return false;
}

/* True for sin x and the like, whose argument is a name. */
static bool stands_without_parentheses(const struct Formula *formula) {
  static const char *const functions[] = {"sin", "cos", "tan", "sinh", "cosh", "tanh", NULL};
  const struct Formula *base = formula->kind == RAISED ? formula->parts[0] : formula;
  bool is_power = formula->kind == RAISED;
  return base->kind == APPLICATION && base->count == 1 && base->parts[0]->kind == NAME &&
         is_one_of(base->word, functions) && (!is_power || formula->parts[1]->kind == NUMBER);
}

bool stands_as_factor(const struct Formula *formula) {
  return formula->kind != SUM && formula->kind != NEGATIVE && formula->kind != CONDITION;
}

bool stands_as_base(const struct Formula *formula) {
  return formula->kind == NUMBER || formula->kind == NAME || formula->kind == APPLICATION || formula->kind == ELLIPSIS;
}

void typeset_parenthesis(FILE *file, const char *parenthesis, bool is_tall) {
  const char *size = is_tall ? "minsize=\"2.2em\" maxsize=\"2.2em\"" : "stretchy=\"false\"";
  fprintf(file, "<mo form=\"%s\" %s>%s</mo>", *parenthesis == '(' ? "prefix" : "postfix", size, parenthesis);
}

static void write_fenced(FILE *file, const struct Formula *formula, bool is_fenced) {
  if (is_fenced) typeset_parenthesis(file, "(", formula->is_tall);
  typeset(file, formula);
  if (is_fenced) typeset_parenthesis(file, ")", formula->is_tall);
}

/*
 * Writes 4/3 for 1.33333333333333. Integrals give such ratios; a number of at least DIGITS characters that is a
 * multiple of 1/3 .. 1/LARGEST to 1e-13 is taken for one.
 */
static bool write_ratio(FILE *file, const char *word) {
  enum { DIGITS = 14, LARGEST = 45 };
  double value = strtod(word, NULL);
  if (strlen(word) < DIGITS || strchr(word, 'e') != NULL) return false;
  for (int below = 3; below <= LARGEST; below++) {
    double above = round(value * below);
    if (above < 1.0 || fabs(value * below - above) > 1e-13 * above) continue;
    fprintf(file, "<mfrac><mn>%.0f</mn><mn>%d</mn></mfrac>", above, below);
    return true;
  }
  return false;
}

/* Writes 4e-05 as 4 times a power of ten. */
static void write_number(FILE *file, const char *word) {
  if (write_ratio(file, word)) return;
  const char *exponent = strchr(word, 'e');
  int length = exponent != NULL ? (int)(exponent - word) : (int)strlen(word);
  fprintf(file, "<mn>%.*s</mn>", length, word);
  if (exponent == NULL) return;
  long power = strtol(exponent + 1, NULL, 10);
  fprintf(file, "<mo>⋅</mo><msup><mn>10</mn><mrow>%s<mn>%ld</mn></mrow></msup>", power < 0 ? "<mo>−</mo>" : "",
          labs(power));
}

static void write_arguments(FILE *file, const struct Formula *formula) {
  for (size_t i = 0; i < formula->count; i++) {
    if (i > 0) fputs("<mo>,</mo>", file);
    typeset(file, formula->parts[i]);
  }
}

void typeset_function(FILE *file, const char *function) {
  fprintf(file, "<mi mathvariant=\"normal\">%s</mi>", function);
}

/* Returns the number of derivatives of a name, in *name; 0 if the formula is not such a derivative. */
static int dots_of(const struct Formula *formula, const char **name) {
  int dots = 0;
  while (formula->kind == APPLICATION && strcmp(formula->word, "der") == 0) {
    formula = formula->parts[0];
    dots++;
  }
  *name = formula->word;
  return formula->kind == NAME && dots <= 2 ? dots : 0;
}

/* Writes the cases of if(c, a, if(d, b, e)), one in each row, with a brace before them. */
static void write_cases(FILE *file, const struct Formula *formula) {
  fputs("<mrow><mo form=\"prefix\" stretchy=\"true\">{</mo><mtable>", file);
  for (; is_choice(formula); formula = formula->parts[2]) {
    fputs("<mtr><mtd>", file);
    typeset(file, formula->parts[1]);
    fputs("</mtd><mtd><mtext>if&#xa0;</mtext>", file);
    typeset(file, formula->parts[0]);
    fputs("</mtd></mtr>", file);
  }
  fputs("<mtr><mtd>", file);
  typeset(file, formula);
  fputs("</mtd><mtd><mtext>else</mtext></mtd></mtr></mtable></mrow>", file);
}

static void write_application(FILE *file, const struct Formula *formula) {
  const char *name;
  int dots = dots_of(formula, &name);
  if (dots > 0) glyphs_write(file, name, dots);
  else if (is_choice(formula)) write_cases(file, formula);
  else if (strcmp(formula->word, "der") == 0) {
    fputs("<mfrac><mi mathvariant=\"normal\">d</mi><mrow><mi mathvariant=\"normal\">d</mi><mi>t</mi></mrow></mfrac>",
          file);
    typeset(file, formula->parts[0]);
  } else if (strcmp(formula->word, "diff") == 0 && formula->count == 2) {
    fputs("<mfrac><mrow><mo>∂</mo>", file);
    typeset(file, formula->parts[0]);
    fputs("</mrow><mrow><mo>∂</mo>", file);
    typeset(file, formula->parts[1]);
    fputs("</mrow></mfrac>", file);
  } else if (strcmp(formula->word, "sqrt") == 0) {
    fputs("<msqrt>", file);
    write_arguments(file, formula);
    fputs("</msqrt>", file);
  } else if (strcmp(formula->word, "abs") == 0) {
    fputs("<mrow><mo>|</mo>", file);
    write_arguments(file, formula);
    fputs("<mo>|</mo></mrow>", file);
  } else {
    fputs("<mrow>", file);
    typeset_function(file, formula->word);
    fputs("<mo>&#x2061;</mo>", file);
    typeset_parenthesis(file, "(", formula->is_tall);
    write_arguments(file, formula);
    typeset_parenthesis(file, ")", formula->is_tall);
    fputs("</mrow>", file);
  }
}

/* Writes sin x or sin² x. */
static void write_without_parentheses(FILE *file, const struct Formula *formula) {
  bool is_power = formula->kind == RAISED;
  const struct Formula *function = is_power ? formula->parts[0] : formula;
  fputs(is_power ? "<mrow><msup>" : "<mrow>", file);
  typeset_function(file, function->word);
  if (is_power) {
    typeset(file, formula->parts[1]);
    fputs("</msup>", file);
  }
  fputs("<mo>&#x2061;</mo><mspace width=\"0.17em\"></mspace>", file);
  typeset(file, function->parts[0]);
  fputs("</mrow>", file);
}

void typeset_times(FILE *file, const struct Formula *next) {
  const struct Formula *first = next;
  while (first->kind == RAISED || first->kind == PRODUCT || first->kind == FRACTION) first = first->parts[0];
  if (first->kind == NUMBER) fputs("<mo>⋅</mo>", file);
  else fputs("<mo>&#x2062;</mo><mspace width=\"0.17em\"></mspace>", file);
}

/* Returns the index of the first trailing factor without parentheses; other factors must not follow these. */
static size_t first_bare(const struct Formula *product) {
  size_t bare = product->count;
  while (bare > 0 && stands_without_parentheses(product->parts[bare - 1])) bare--;
  return bare;
}

static void write_raised(FILE *file, const struct Formula *formula) {
  fputs("<msup><mrow>", file);
  write_fenced(file, formula->parts[0], !stands_as_base(formula->parts[0]));
  fputs("</mrow><mrow>", file);
  typeset(file, formula->parts[1]);
  fputs("</mrow></msup>", file);
}

void typeset_factor(FILE *file, const struct Formula *product, size_t i) {
  if (i >= first_bare(product)) write_without_parentheses(file, product->parts[i]);
  else if (product->parts[i]->kind == APPLICATION) write_application(file, product->parts[i]);
  else if (product->parts[i]->kind == RAISED) write_raised(file, product->parts[i]);
  else write_fenced(file, product->parts[i], !stands_as_factor(product->parts[i]));
}

static void write_product(FILE *file, const struct Formula *formula) {
  for (size_t i = 0; i < formula->count; i++) {
    if (i > 0) typeset_times(file, formula->parts[i]);
    typeset_factor(file, formula, i);
  }
}

static void write_fraction(FILE *file, const struct Formula *formula) {
  fputs("<mfrac><mrow>", file);
  typeset(file, formula->parts[0]);
  fputs("</mrow><mrow>", file);
  typeset(file, formula->parts[1]);
  fputs("</mrow></mfrac>", file);
}

void typeset_sign(FILE *file, const struct Formula **term, bool first) {
  if ((*term)->kind == NEGATIVE) {
    *term = (*term)->parts[0];
    fputs(first ? "<mo form=\"prefix\">−</mo>" : "<mo form=\"infix\">−</mo>", file);
  } else if (!first && (*term)->kind != ELLIPSIS) fputs("<mo form=\"infix\">+</mo>", file);
}

static void write_sum(FILE *file, const struct Formula *formula) {
  for (size_t i = 0; i < formula->count; i++) {
    const struct Formula *term = formula->parts[i];
    typeset_sign(file, &term, i == 0);
    write_fenced(file, term, !stands_as_factor(term));
  }
}

void typeset(FILE *file, const struct Formula *formula) {
  const struct Formula *inside = formula;
  if (stands_without_parentheses(formula)) {
    write_without_parentheses(file, formula);
    return;
  }
  switch (formula->kind) {
  case NUMBER: write_number(file, formula->word); break;
  case NAME: glyphs_write(file, formula->word, 0); break;
  case ELLIPSIS: fputs("<mo>…</mo>", file); break;
  case APPLICATION: write_application(file, formula); break;
  case CONDITION:
    typeset(file, formula->parts[0]);
    fputs("<mo>&gt;</mo>", file);
    typeset(file, formula->parts[1]);
    break;
  case SUM: write_sum(file, formula); break;
  case NEGATIVE:
    typeset_sign(file, &inside, true);
    write_fenced(file, inside, !stands_as_factor(inside));
    break;
  case PRODUCT: write_product(file, formula); break;
  case FRACTION: write_fraction(file, formula); break;
  case RAISED: write_raised(file, formula); break;
  }
}
