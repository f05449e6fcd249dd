/*
 * Translates a formula by recursive descent for the grammar
 *
 *     sum = ["-"] product {("+" | "-") product}      power = primary ["^" ["-"] primary]
 *     product = power {("*" | "/") power}            argument = sum [">" sum]
 *     primary = number | name ["(" argument {"," argument} ")"] | "(" sum ")" | "..."
 *
 * where "..." stands for omitted terms. Each function returns the LaTeX of its part, and what decides on parentheses
 * around it. Reads each character once; the recursion is as deep as the parentheses.
 */
#include "latex.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "page.h"

/* Longest side of an equation, in characters, and most nested parentheses, which bound the memory and the stack. */
enum { SIDE_LIMIT = 4000, NESTING_LIMIT = 100 };

/* Most arguments of a function; tables have fewer. */
enum { ARGUMENT_LIMIT = 8 };

static const char *const greek[] = {"alpha",  "beta",   "gamma", "delta", "epsilon", "zeta",  "eta",   "theta",
                                    "kappa",  "lambda", "mu",    "nu",    "xi",      "pi",    "rho",   "sigma",
                                    "tau",    "phi",    "chi",   "psi",   "omega",   "Gamma", "Delta", "Theta",
                                    "Lambda", "Xi",     "Pi",    "Sigma", "Phi",     "Psi",   "Omega", NULL};

/* Functions of which sin(x) is shown as sin x, and the others that LaTeX knows. */
static const char *const bare_functions[] = {"sin", "cos", "tan", "sinh", "cosh", "tanh", NULL};
static const char *const known_functions[] = {"log", "exp", "min", "max", NULL};

/* A sum is in parentheses as a factor, and all but single objects are as the base of a power. */
enum Grade { GRADE_SUM, GRADE_PRODUCT, GRADE_SINGLE };

/* The LaTeX of a part. */
struct Formula {
  char *text;
  char *at_end; /* the form that ends a product, sin x for sin(x); NULL if it is the same */
  enum Grade grade;
  bool is_number;
  bool begins_with_number;
  const char *variable; /* its name, also of a derivative; NULL for other formulas */
  int dots;             /* of a variable's derivative */
  const char *function; /* of a call whose powers are sin^2 x; else NULL */
  const char *rows;     /* of cases; else NULL */
};

struct Reader {
  const char *at; /* the next character */
  const struct Model *model;
  int depth;
  bool has_failed;
};

static struct Formula read_sum(struct Reader *reader);

/* True if the list, which ends with NULL, contains the first length characters of the word. */
static bool contains(const char *const *list, const char *word, size_t length) {
  while (*list != NULL && (strlen(*list) != length || strncmp(*list, word, length) != 0)) list++;
  return *list != NULL;
}

static bool take(struct Reader *reader, const char *token) {
  while (*reader->at == ' ') reader->at++;
  size_t length = strlen(token);
  if (strncmp(reader->at, token, length) != 0) return false;
  reader->at += length;
  return true;
}

static void demand(struct Reader *reader, const char *token) {
  if (!take(reader, token)) reader->has_failed = true;
}

static char *part_of(const char *text, size_t length) {
  return format_text("%.*s", (int)length, text);
}

/* Returns letters in upright type; an index of digits alone is a number. */
static char *upright(const char *text, size_t length) {
  struct TextStream escaped;
  FILE *file = open_text(&escaped);
  for (size_t i = 0; i < length; i++) fprintf(file, text[i] == '_' ? "\\%c" : "%c", text[i]);
  return format_text("\\mathrm{%s}", close_text(&escaped));
}

static void append_latex(char **indices, char *index) {
  *indices = *indices == NULL ? index : format_text("%s, %s", *indices, index);
}

static void append_index(char **indices, const char *text, size_t length) {
  if (length > 0) append_latex(indices, isdigit((unsigned char)*text) ? part_of(text, length) : upright(text, length));
}

/* Returns the length of a word's base, before its index: of omega in omegaCoupler, and of x in x_end. */
static size_t base_length(const char *word, size_t length) {
  size_t capital = 1;
  while (capital < length && !isupper((unsigned char)word[capital])) capital++;
  if (capital < length && contains(greek, word, capital)) return capital;
  const char *low = length > 2 ? memchr(word + 1, '_', length - 2) : NULL;
  return low != NULL ? (size_t)(low - word) : length;
}

/* True for the force of a constraint, whose name the model has chosen: its multiplier. */
static bool is_multiplier(const struct Model *model, const char *name) {
  for (size_t i = 0; i < model->constraints.count; i++) {
    const struct Variable *constraint = &model->constraints.items[i];
    if (constraint->force_name == NULL && strcmp(constraint_force_name(constraint), name) == 0) return true;
  }
  return false;
}

/* Returns the length of a text in brackets, which may contain others. */
static size_t bracket_length(const char *text) {
  size_t length = 0;
  int depth = 0;
  do depth += (text[length] == '[') - (text[length] == ']');
  while (text[++length] != '\0' && depth > 0);
  return length;
}

/* Returns the last point of a name outside of brackets; NULL if there is none. */
static const char *last_point(const char *name) {
  const char *last = NULL;
  for (; *name != '\0'; name += *name == '[' ? bracket_length(name) : 1)
    if (*name == '.') last = name;
  return last;
}

/* Returns the name of the coordinate of which a velocity has the name with one letter before it: x of vx; else NULL. */
static const char *coordinate_of(const struct Model *model, const char *velocity) {
  for (size_t i = 0; i < model->velocities.count; i++)
    if (strcmp(model->velocities.items[i].name, velocity) == 0) {
      const char *coordinate = model->coordinates.items[i].name;
      return strcmp(velocity + 1, coordinate) == 0 ? coordinate : NULL;
    }
  return NULL;
}

static char *symbol(const struct Model *model, const char *name, int dots);

/* Returns the length of a name before the digits at its end. */
static size_t length_without_number(const char *word, size_t length) {
  size_t digits = length;
  while (digits > 0 && isdigit((unsigned char)word[digits - 1])) digits--;
  return digits > 0 && word[digits - 1] == '_' ? length : digits;
}

/* Appends the indices in brackets: numbers, and names such as theta1 in Q[theta1]. */
static void append_bracket(const struct Model *model, char **indices, const char *bracket) {
  size_t length = bracket_length(bracket);
  const char *inside = part_of(bracket + 1, length - 2);
  append_latex(indices, isdigit((unsigned char)*inside) ? copy_text(inside) : symbol(model, inside, 0));
}

/*
 * Returns a name as a base with dots, and its indices: theta1, theta[1] and omegaCoupler become Greek letters with an
 * index, and x_end gets one too. The velocity vx of x is v with the index x. The part of the system that a name belongs
 * to is the last index. The force of a constraint is lambda, and another loop.force is F, both with the name of the loop.
 */
static char *symbol(const struct Model *model, const char *name, int dots) {
  if (strcmp(name, "time") == 0) return copy_text(page_symbol(model, "t", "\\mathrm{time}"));
  const char *point = last_point(name), *word = point != NULL ? point + 1 : name,
             *coordinate = coordinate_of(model, name);
  size_t length = strcspn(word, "["), digits = word[length] == '[' ? length : length_without_number(word, length);
  size_t base = base_length(word, digits), after = base + (base < digits && word[base] == '_');
  char *indices = NULL;
  if (coordinate != NULL) {
    indices = symbol(model, coordinate, 0);
    base = 1;
  } else {
    append_index(&indices, word + after, digits - after);
    append_index(&indices, word + digits, length - digits);
    for (const char *at = word + length; *at == '['; at += bracket_length(at)) append_bracket(model, &indices, at);
  }
  if (point != NULL) append_index(&indices, name, (size_t)(point - name));
  if (point != NULL && strcmp(word, "force") == 0) {
    word = is_multiplier(model, name) ? "lambda" : "F";
    base = strlen(word);
  }
  const char *letter = contains(greek, word, base) ? format_text("\\%.*s", (int)base, word)
                       : base == 1                 ? part_of(word, 1)
                                                   : upright(word, base);
  const char *dotted = dots == 0 ? letter : format_text(dots == 1 ? "\\dot{%s}" : "\\ddot{%s}", letter);
  return indices != NULL ? format_text("%s_{%s}", dotted, indices) : copy_text(dotted);
}

static bool is_tall(const char *text) {
  return strstr(text, "\\frac") != NULL || strstr(text, "\\begin") != NULL;
}

static char *fenced(const char *text) {
  return format_text(is_tall(text) ? "\\left(%s\\right)" : "(%s)", text);
}

/* Returns the text of a formula with nothing after it: of a numerator, an argument or a whole expression. */
static char *alone(const struct Formula *formula) {
  return formula->at_end != NULL ? formula->at_end : formula->text;
}

/* Returns the text of a formula as a term. */
static char *term(const struct Formula *formula) {
  return formula->grade == GRADE_SUM ? fenced(formula->text) : alone(formula);
}

/* Returns the text of a formula as a factor, after which others may follow. */
static char *factor(const struct Formula *formula) {
  return formula->grade == GRADE_SUM ? fenced(formula->text) : formula->text;
}

/* Returns a product; trailing functions alone have no parentheses, as other factors must not follow these. */
static struct Formula product_of(const struct Formula *left, const struct Formula *right) {
  const char *times = right->begins_with_number ? " \\cdot " : " \\, ";
  const char *before = left->at_end != NULL ? left->at_end : factor(left);
  return (struct Formula){
      .text = format_text("%s%s%s", factor(left), times, factor(right)),
      .at_end = right->at_end != NULL ? format_text("%s%s%s", before, times, right->at_end) : NULL,
      .grade = GRADE_PRODUCT,
      .begins_with_number = left->begins_with_number,
  };
}

static struct Formula fraction_of(const struct Formula *above, const struct Formula *below) {
  return (struct Formula){
      .text = format_text("\\frac{%s}{%s}", alone(above), alone(below)),
      .grade = GRADE_PRODUCT,
      .begins_with_number = above->begins_with_number,
  };
}

/* Returns a number; 4e-05 is 4 times a power of ten. */
static struct Formula read_number(struct Reader *reader) {
  size_t mantissa = strspn(reader->at, "0123456789."), length = mantissa;
  struct Formula number = {.grade = GRADE_SINGLE, .is_number = true, .begins_with_number = true};
  number.text = part_of(reader->at, mantissa);
  if (reader->at[mantissa] == 'e') {
    char *end;
    long exponent = strtol(reader->at + mantissa + 1, &end, 10);
    number.text = format_text("%s \\cdot 10^{%ld}", number.text, exponent);
    length = (size_t)(end - reader->at);
  }
  reader->at += length;
  return number;
}

/* Returns the time derivative: of a variable a dot, of other formulas d/dt before them. */
static struct Formula derivative_of(const struct Model *model, const struct Formula *inside) {
  struct Formula derivative = *inside;
  if (inside->variable != NULL && inside->dots < 2) {
    derivative.text = symbol(model, inside->variable, ++derivative.dots);
    return derivative;
  }
  return (struct Formula){.text = format_text("\\frac{\\mathrm{d}}{\\mathrm{d} t} %s", factor(inside)),
                          .grade = GRADE_PRODUCT};
}

/* Returns if(c, a, if(d, b, e)) as cases, one in each row. */
static struct Formula cases_of(const struct Formula *arguments) {
  const struct Formula *other = &arguments[2];
  const char *rest = other->rows != NULL ? other->rows : format_text("%s & \\text{else}", alone(other));
  char *rows = format_text("%s & \\text{if } %s \\\\ %s", alone(&arguments[1]), alone(&arguments[0]), rest);
  return (struct Formula){
      .text = format_text("\\begin{cases} %s \\end{cases}", rows), .rows = rows, .grade = GRADE_PRODUCT};
}

static struct Formula function_of(const char *word, const struct Formula *arguments, size_t count) {
  bool is_bare = contains(bare_functions, word, strlen(word));
  bool is_known = is_bare || contains(known_functions, word, strlen(word));
  char *head = format_text(is_known ? "\\%s" : "\\operatorname{%s}", word), *list = alone(&arguments[0]);
  for (size_t i = 1; i < count; i++) list = format_text("%s, %s", list, alone(&arguments[i]));
  bool is_of_name = arguments[0].variable != NULL && arguments[0].dots == 0;
  return (struct Formula){
      .text = format_text("%s%s", head, fenced(list)),
      .at_end = is_bare && is_of_name ? format_text("%s %s", head, list) : NULL,
      .function = is_bare ? head : NULL,
      .grade = GRADE_SINGLE,
  };
}

static struct Formula call_of(const struct Model *model, const char *word, const struct Formula *arguments,
                              size_t count) {
  struct Formula call = {.grade = GRADE_SINGLE};
  if (strcmp(word, "if") == 0 && count == 3) return cases_of(arguments);
  if (strcmp(word, "der") == 0) return derivative_of(model, &arguments[0]);
  if (strcmp(word, "sqrt") == 0) call.text = format_text("\\sqrt{%s}", alone(&arguments[0]));
  else if (strcmp(word, "abs") == 0) call.text = format_text("\\left|%s\\right|", alone(&arguments[0]));
  else if (strcmp(word, "diff") == 0 && count == 2)
    call.text = format_text("\\frac{\\partial %s}{\\partial %s}", alone(&arguments[0]), alone(&arguments[1]));
  else return function_of(word, arguments, count);
  return call;
}

static struct Formula read_argument(struct Reader *reader) {
  struct Formula left = read_sum(reader);
  if (!take(reader, ">")) return left;
  struct Formula right = read_sum(reader);
  return (struct Formula){.text = format_text("%s > %s", alone(&left), alone(&right)), .grade = GRADE_SUM};
}

/* Returns the length of a name, which may contain points and brackets, but not the points of "...". */
static size_t name_length(const char *text) {
  size_t length = 0;
  while (isalnum((unsigned char)text[length]) || text[length] == '_' || text[length] == '[' ||
         (text[length] == '.' && text[length + 1] != '.'))
    length += text[length] == '[' ? bracket_length(text + length) : 1;
  return length;
}

static struct Formula read_name(struct Reader *reader) {
  struct Formula arguments[ARGUMENT_LIMIT];
  size_t length = name_length(reader->at), count = 0;
  char *name = part_of(reader->at, length);
  reader->at += length;
  if (!take(reader, "("))
    return (struct Formula){.text = symbol(reader->model, name, 0), .variable = name, .grade = GRADE_SINGLE};
  do arguments[count++] = read_argument(reader);
  while (take(reader, ",") && count < ARGUMENT_LIMIT);
  demand(reader, ")");
  return call_of(reader->model, name, arguments, count);
}

static struct Formula read_primary(struct Reader *reader) {
  struct Formula inside = {.text = copy_text("\\dots"), .grade = GRADE_SINGLE};
  if (take(reader, "...")) return inside;
  while (*reader->at == ' ') reader->at++;
  if (isdigit((unsigned char)*reader->at)) return read_number(reader);
  if (isalpha((unsigned char)*reader->at) || *reader->at == '_') return read_name(reader);
  demand(reader, "(");
  if (reader->has_failed) return inside;
  inside = read_sum(reader);
  demand(reader, ")");
  return inside;
}

/* Returns a power; that of a trigonometric function has the exponent before the argument. */
static struct Formula read_power(struct Reader *reader) {
  struct Formula base = read_primary(reader);
  if (!take(reader, "^")) return base;
  const char *sign = take(reader, "-") ? "-" : "";
  struct Formula exponent = read_primary(reader), power = {.grade = GRADE_PRODUCT};
  power.begins_with_number = base.begins_with_number;
  const char *above = format_text("%s%s", sign, *sign != '\0' ? term(&exponent) : alone(&exponent));
  if (base.function != NULL && exponent.is_number) {
    size_t head = strlen(base.function);
    power.text = format_text("%s^{%s}%s", base.function, above, base.text + head);
    if (base.at_end != NULL) power.at_end = format_text("%s^{%s}%s", base.function, above, base.at_end + head);
  } else {
    char *below = base.grade == GRADE_SINGLE ? base.text : fenced(base.text);
    power.text = format_text("%s^{%s}", below, above);
  }
  return power;
}

static struct Formula read_product(struct Reader *reader) {
  struct Formula whole = read_power(reader);
  for (;;) {
    bool is_product = take(reader, "*");
    if (!is_product && !take(reader, "/")) return whole;
    struct Formula next = read_power(reader);
    whole = is_product ? product_of(&whole, &next) : fraction_of(&whole, &next);
  }
}

/* Returns the sign before the next term; NULL if there is none. */
static const char *take_sign(struct Reader *reader) {
  if (take(reader, "+")) return " + ";
  if (take(reader, "-")) return " - ";
  return strncmp(reader->at, "...", 3) == 0 ? " " : NULL;
}

static struct Formula read_sum(struct Reader *reader) {
  struct Formula whole = {.text = copy_text(""), .grade = GRADE_SUM};
  const char *sign = take(reader, "-") ? "-" : NULL;
  if (++reader->depth > NESTING_LIMIT) reader->has_failed = true;
  if (reader->has_failed) return whole;
  if (sign == NULL) whole = read_product(reader);
  while (sign != NULL || (sign = take_sign(reader)) != NULL) {
    struct Formula next = read_product(reader);
    whole.text = format_text("%s%s%s", alone(&whole), sign, term(&next));
    whole = (struct Formula){.text = whole.text, .grade = GRADE_SUM};
    sign = NULL;
  }
  reader->depth--;
  return whole;
}

char *latex_of(const struct Model *model, const char *text) {
  struct Reader reader = {.at = text, .model = model, .has_failed = strlen(text) > SIDE_LIMIT};
  struct Formula whole = read_sum(&reader);
  return reader.has_failed || *reader.at != '\0' ? NULL : alone(&whole);
}

char *latex_of_equation(const struct Model *model, const char *left, const char *right) {
  const char *sides[] = {latex_of(model, left), latex_of(model, right)};
  return sides[0] != NULL && sides[1] != NULL ? format_text("%s = %s", sides[0], sides[1]) : copy_text("");
}
