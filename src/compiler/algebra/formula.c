#include "algebra/formula.h"

#include <math.h>
#include <stdlib.h>

#include "algebra/simplify.h"
#include "base/memory.h"

/* Longest formula, in bytes, and deepest recursion; beyond them the text is cut off. */
enum { LENGTH_LIMIT = 20000, DEPTH_LIMIT = 2000 };

/* Context of an expression: a sum in a product, and a product in a power, need parentheses. */
enum Precedence { IN_SUM, IN_PRODUCT, IN_POWER };

/* State while an expression is printed. */
struct Printer {
  FILE *file;
  const struct Graph *graph;
  const struct NodeNames *names; /* NULL for none */
  Node whole;                    /* the printed expression, which is not replaced by its name */
  int depth;
};

static void print(struct Printer *printer, Node node, enum Precedence tightness);

void number_text(double value, char text[NUMBER_LENGTH]) {
  for (int digits = 15; digits <= 17; digits++) {
    snprintf(text, NUMBER_LENGTH, "%.*g", digits, value);
    if (strtod(text, NULL) == value) return;
  }
}

void print_number(FILE *file, double value) {
  char text[NUMBER_LENGTH];
  number_text(value, text);
  fputs(text, file);
}

static bool is_truncated(struct Printer *printer) {
  if (ftell(printer->file) < LENGTH_LIMIT && printer->depth < DEPTH_LIMIT) return false;
  fputs("...", printer->file);
  return true;
}

/* Returns the name that stands for a node; NULL for none. */
static const char *name_of(const struct Printer *printer, Node node) {
  const struct NodeNames *names = printer->names;
  return names != NULL && node != printer->whole && (size_t)node < names->count ? names->of[node] : NULL;
}

/* Returns a named power r of the base with base^exponent = r^*exponent for a whole *exponent; base if there is none. */
static Node named_root(const struct Printer *printer, Node base, double *exponent) {
  const struct Vertex *vertices = printer->graph->vertices;
  for (size_t i = 0; printer->names != NULL && i < printer->names->named_count; i++) {
    Node node = printer->names->named[i];
    if (node == printer->whole || vertices[node].operation != POWER || vertices[node].left != base) continue;
    if (!graph_is_constant(printer->graph, vertices[node].right)) continue;
    double multiple = *exponent / graph_value(printer->graph, vertices[node].right);
    if (multiple < 1.0 || multiple != floor(multiple)) continue;
    *exponent = multiple;
    return node;
  }
  return base;
}

/* Prints 15 digits: the other two of a double show only rounding. */
static void print_rounded(FILE *file, double value) {
  fprintf(file, "%.15g", value);
}

static void print_power(struct Printer *printer, Node base, double exponent) {
  base = named_root(printer, base, &exponent);
  if (exponent == 0.5) {
    fputs("sqrt(", printer->file);
    print(printer, base, IN_SUM);
    fputs(")", printer->file);
    return;
  }
  print(printer, base, exponent == 1.0 ? IN_PRODUCT : IN_POWER);
  if (exponent == 1.0) return;
  fputs("^", printer->file);
  print_rounded(printer->file, exponent);
}

/* Prints the numerator (sign 1) or denominator (sign -1): the number unless it is 1, and factors of that sign. */
static void print_factors(struct Printer *printer, double number, const struct Factor *factors, int count, int sign) {
  const char *separator = "";
  if (number != 1.0) {
    print_rounded(printer->file, number);
    separator = "*";
  }
  for (int i = 0; i < count; i++) {
    if (factors[i].exponent * sign < 0) continue;
    fputs(separator, printer->file);
    print_power(printer, factors[i].base, factors[i].exponent * sign);
    separator = "*";
  }
  if (*separator == '\0') fputs("1", printer->file);
}

/* Prints a product with a positive coefficient. */
static void print_product(struct Printer *printer, double coefficient, Node base) {
  struct Factor factors[FACTOR_LIMIT];
  bool named = name_of(printer, base) != NULL;
  int count = named ? 1 : factors_of(printer->graph, base, factors);
  if (named) factors[0] = (struct Factor){.base = base, .exponent = 1.0};
  if (count < 0) {
    const struct Vertex *vertex = &printer->graph->vertices[base];
    if (coefficient != 1.0) {
      print_rounded(printer->file, coefficient);
      fputs("*", printer->file);
    }
    print(printer, vertex->left, IN_PRODUCT);
    fputs("*", printer->file);
    print(printer, vertex->right, IN_PRODUCT);
    return;
  }
  double inverse = 1.0 / coefficient;
  bool fraction = coefficient < 1.0 && inverse == floor(inverse);
  int below = fraction ? 1 : 0;
  for (int i = 0; i < count; i++) below += factors[i].exponent < 0;
  print_factors(printer, fraction ? 1.0 : coefficient, factors, count, 1);
  if (below == 0) return;
  fputs(below > 1 ? "/(" : "/", printer->file);
  print_factors(printer, fraction ? inverse : 1.0, factors, count, -1);
  if (below > 1) fputs(")", printer->file);
}

/*
 * Returns the condition if guard_condition is 1 - guard(condition, 1), which is positive where the condition does not
 * hold; ZERO for other nodes.
 */
static Node opposite_of(const struct Graph *graph, Node guard_condition) {
  const struct Vertex *sum = &graph->vertices[guard_condition], *guard;
  Node base;
  if (sum->operation != ADD) return ZERO;
  Node other = sum->left == ONE ? sum->right : sum->right == ONE ? sum->left : ZERO;
  if (other == ZERO || coefficient_of(graph, other, &base) != -1.0) return ZERO;
  guard = &graph->vertices[base];
  return guard->operation == GUARD && guard->right == ONE ? guard->left : ZERO;
}

bool choice_of(const struct Graph *graph, Node node, struct Conditional *choice) {
  const struct Vertex *vertices = graph->vertices, *vertex = &vertices[node];
  if (vertex->operation == GUARD) {
    Node opposite = opposite_of(graph, vertex->left);
    *choice = opposite != ZERO ? (struct Conditional){opposite, ZERO, vertex->right}
                               : (struct Conditional){vertex->left, vertex->right, ZERO};
    return true;
  }
  if (vertex->operation != ADD) return false;
  const struct Vertex *left = &vertices[vertex->left], *right = &vertices[vertex->right];
  if (left->operation != GUARD || right->operation != GUARD) return false;
  bool is_swapped = opposite_of(graph, left->left) == right->left;
  const struct Vertex *first = is_swapped ? right : left, *second = is_swapped ? left : right;
  *choice = (struct Conditional){first->left, first->right, second->right};
  return opposite_of(graph, second->left) == first->left;
}

/* Prints if(a > 0, ...) for a guard by sign(a). */
static void print_choice(struct Printer *printer, const struct Conditional *choice) {
  const struct Graph *graph = printer->graph;
  Node base = choice->guard_condition;
  double coefficient = coefficient_of(graph, choice->guard_condition, &base);
  bool is_sign = graph->vertices[base].operation == SIGN && name_of(printer, base) == NULL;
  bool is_below = is_sign && coefficient < 0.0;
  fputs(is_below ? "if(0 > " : "if(", printer->file);
  print(printer, is_sign ? graph->vertices[base].left : choice->guard_condition, IN_SUM);
  fputs(is_below ? ", " : " > 0, ", printer->file);
  print(printer, choice->positive, IN_SUM);
  fputs(", ", printer->file);
  print(printer, choice->other, IN_SUM);
  fputs(")", printer->file);
}

static void print_term(struct Printer *printer, Node node, bool first) {
  struct Conditional choice;
  bool is_sum = printer->graph->vertices[node].operation == ADD && !choice_of(printer->graph, node, &choice);
  if (is_sum && name_of(printer, node) == NULL) {
    if (is_truncated(printer)) return;
    printer->depth++;
    print_term(printer, printer->graph->vertices[node].left, first);
    print_term(printer, printer->graph->vertices[node].right, false);
    printer->depth--;
    return;
  }
  Node base = node;
  double coefficient = name_of(printer, node) == NULL ? coefficient_of(printer->graph, node, &base) : 1.0;
  if (coefficient < 0) fputs(first ? "-" : " - ", printer->file);
  else if (!first) fputs(" + ", printer->file);
  if (base == ONE) print_rounded(printer->file, fabs(coefficient));
  else print_product(printer, fabs(coefficient), base);
}

/* Prints a bounded function as the formula that authors write. False for other functions. */
static bool print_bounded(struct Printer *printer, const struct Vertex *vertex) {
  Node base;
  double coefficient = coefficient_of(printer->graph, vertex->left, &base);
  switch (vertex->operation) {
  case LOGISTIC:
    fputs(coefficient < 0.0 ? "1/(1 + exp(" : "1/(1 + exp(-", printer->file);
    print_product(printer, fabs(coefficient), base);
    break;
  case SOFTPLUS:
    fputs("log(1 + exp(", printer->file);
    print(printer, vertex->left, IN_SUM);
    break;
  case SECH:
  case LOG_COSH:
    fputs(vertex->operation == SECH ? "1/cosh(" : "log(cosh(", printer->file);
    print(printer, vertex->left, IN_SUM);
    break;
  case CAPPED_EXPONENTIAL:
  case CAPPED_SLOPE:
    fputs("exp(", printer->file);
    print(printer, vertex->left, IN_SUM);
    break;
  default: return false;
  }
  bool is_nested = vertex->operation == LOGISTIC || vertex->operation == SOFTPLUS || vertex->operation == LOG_COSH;
  fputs(is_nested ? "))" : ")", printer->file);
  return true;
}

static void print_function(struct Printer *printer, const struct Vertex *vertex) {
  if (print_bounded(printer, vertex)) return;
  fprintf(printer->file, "%s(", operation_name(vertex->operation));
  print(printer, vertex->left, IN_SUM);
  if (operation_arity(vertex->operation) == 2) {
    fputs(", ", printer->file);
    print(printer, vertex->right, IN_SUM);
  }
  fputs(")", printer->file);
}

static void print(struct Printer *printer, Node node, enum Precedence tightness) {
  if (is_truncated(printer)) return;
  const char *name = name_of(printer, node);
  if (name != NULL) {
    fputs(name, printer->file);
    return;
  }
  printer->depth++;
  const struct Vertex *vertex = &printer->graph->vertices[node];
  Node base;
  struct Conditional choice;
  bool is_choice = choice_of(printer->graph, node, &choice);
  bool sum = !is_choice && (vertex->operation == ADD || coefficient_of(printer->graph, node, &base) < 0);
  bool product = vertex->operation == MULTIPLY || vertex->operation == POWER;
  bool variable_power = vertex->operation == POWER && !graph_is_constant(printer->graph, vertex->right);
  bool quotient = vertex->operation == LOGISTIC || vertex->operation == SECH;
  bool parentheses = ((sum || quotient) && tightness > IN_SUM) || (product && tightness > IN_PRODUCT);
  if (parentheses) fputs("(", printer->file);
  if (is_choice) print_choice(printer, &choice);
  else if (variable_power) {
    print(printer, vertex->left, IN_POWER);
    fputs("^", printer->file);
    print(printer, vertex->right, IN_POWER);
  } else if (sum || product || vertex->operation == CONSTANT) print_term(printer, node, true);
  else if (vertex->operation == SYMBOL) fputs(graph_symbol_of(printer->graph, node)->name, printer->file);
  else print_function(printer, vertex);
  if (parentheses) fputs(")", printer->file);
  printer->depth--;
}

char *expression_text(const struct Graph *graph, Node node) {
  return expression_text_with_names(graph, node, NULL);
}

char *expression_text_with_names(const struct Graph *graph, Node node, const struct NodeNames *names) {
  struct TextStream text;
  FILE *file = open_text(&text);
  struct Printer printer = {.file = file, .graph = graph, .names = names, .whole = node};
  print(&printer, node, IN_SUM);
  return close_text(&text);
}
