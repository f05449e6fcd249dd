#include "display/display.h"

#include <math.h>
#include <string.h>

#include "algebra/polynomials/rational.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "display/addition_theorems.h"
#include "display/products.h"
#include "display/natural_order.h"

/* Longest text of a part, in characters; with a longer part, the whole is printed as by formula.h. */
enum { LENGTH_LIMIT = 4000 };

/* Deepest nesting of parts; a deeper expression is printed as by formula.h. It bounds the stack. */
enum { DEPTH_LIMIT = 60 };

/* Longest sum, in characters, that is easy to read as a factor, such as 1 - cos(theta). */
enum { SHORT_SUM = 24 };

/* Steps of graph_work() that the searches for forms take at most, and those that they leave to what follows. */
enum { SEARCH_WORK = WORK_LIMIT / 10 * 7, RESERVED_WORK = WORK_LIMIT / 20 };

/*
 * Weights of the length of a form. A form without expansion counts 1.4 times, since products of inertia are easier
 * to read when multiplied out. A whole side of an equation that is one product counts 1.25 times.
 */
static const double compact = 1.4, factored = 1.25;

/* Returns the text of a node that is part of another, and remembers it; NULL if it is too long. */
static const char *text_inside(struct Display *display, Node node);

/* Returns if(a > 0, ...); a closed contact is a condition by itself. */
static char *choice_text(struct Display *display, const struct Conditional *choice) {
  const struct Graph *graph = display->graph;
  Node base = choice->guard_condition;
  double coefficient = coefficient_of(graph, base, &base);
  const struct Vertex *vertex = &graph->vertices[base];
  bool is_sign = vertex->operation == SIGN;
  const char *condition = text_inside(display, is_sign ? vertex->left : choice->guard_condition);
  const char *positive = text_inside(display, choice->positive), *other = text_inside(display, choice->other);
  if (condition == NULL || positive == NULL || other == NULL) return NULL;
  return format_text(is_sign && coefficient < 0.0 ? "if(0 > %s, %s, %s)" : "if(%s > 0, %s, %s)", condition, positive,
                     other);
}

static char *function_text(struct Display *display, Node node) {
  const struct Vertex vertex = display->graph->vertices[node];
  const char *left = text_inside(display, vertex.left);
  if (left == NULL) return NULL;
  switch (vertex.operation) {
  case LOGISTIC:
  case SOFTPLUS:
  case SECH:
  case LOG_COSH: return expression_text_with_names(display->graph, node, display->names);
  default: break;
  }
  if (operation_arity(vertex.operation) == 1) return format_text("%s(%s)", operation_name(vertex.operation), left);
  const char *right = text_inside(display, vertex.right);
  if (right == NULL) return NULL;
  if (vertex.operation == POWER) return format_text("%s^%s", fenced_base(left), fenced_base(right));
  return format_text("%s(%s, %s)", operation_name(vertex.operation), left, right);
}

/* Returns the text of an atom; NULL if it is too long. */
static const char *atom_text(struct Display *display, const struct Atoms *atoms, Node node) {
  const struct Graph *graph = display->graph;
  const char *name = displayed_name(atoms, node);
  struct Conditional choice;
  if (name != NULL) return name;
  if (graph->vertices[node].operation == SYMBOL) return graph_symbol_of(graph, node)->name;
  if (choice_of(graph, node, &choice)) return choice_text(display, &choice);
  enum Operation operation = graph->vertices[node].operation;
  bool is_sum = operation == ADD || operation == MULTIPLY || operation == CONSTANT ||
                (operation == POWER && graph_is_constant(graph, graph->vertices[node].right));
  return is_sum ? text_inside(display, node) : function_text(display, node);
}

/* Fills in the texts of all atoms that the terms have. Returns false if one is too long. */
static bool find_atom_texts(struct Display *display, const struct Atoms *atoms, const struct Terms *terms,
                            const char **texts) {
  for (int k = 0; k < atoms->count; k++) {
    bool is_used = false;
    for (size_t i = 0; i < terms->count; i++) is_used |= terms->items[i].exponents[k] != 0.0;
    texts[k] = is_used ? atom_text(display, atoms, atoms->nodes[k]) : "";
    if (texts[k] == NULL || strlen(texts[k]) > LENGTH_LIMIT) return false;
  }
  return true;
}

/* True for a product of which one factor is a long sum with functions. */
static bool is_factored(const struct Atoms *atoms, const struct Terms *terms, const char *const *texts) {
  bool has_sum = false;
  for (int k = 0; k < atoms->count && terms->count == 1; k++)
    has_sum |= terms->items[0].exponents[k] == 1.0 && factor_rank(atoms, atoms->nodes[k]) == RANK_SUM &&
               strlen(texts[k]) > SHORT_SUM && strchr(texts[k], '(') != NULL;
  return has_sum;
}

/* Returns the text of one form, and the weight of its length in *weight; NULL if it is too large. */
static char *text_of_form(struct Display *display, Node node, enum ProductExpansion expansion, bool is_whole,
                          double *weight) {
  struct Atoms atoms = {
      .graph = display->graph, .names = display->names, .whole = is_whole ? node : (Node)-1, .expansion = expansion};
  const char *texts[ATOM_ROOM] = {NULL};
  struct Terms terms = terms_of_expression(&atoms, node);
  apply_addition_theorems(&atoms, &terms);
  char *text = NULL;
  if (!atoms.is_full && find_atom_texts(display, &atoms, &terms, texts))
    text = sum_in_natural_order(&atoms, &terms, texts);
  *weight = expansion == EXPAND_NONE ? compact : 1.0;
  if (text != NULL && is_whole && is_factored(&atoms, &terms, texts)) *weight *= factored;
  release(terms.items);
  return text;
}

/* True if further searches for forms would take too many steps. */
static bool has_to_save_work(struct Display *display) {
  size_t left = graph_work_left(display->graph);
  if (display->work_left == 0) display->work_left = left;
  return left < RESERVED_WORK || display->work_left - left > SEARCH_WORK;
}

/* Returns the shortest of the forms of a node; NULL if all are too large, or their search would take too many steps. */
static char *shortest_text(struct Display *display, Node node, bool is_whole) {
  static const enum ProductExpansion expansions[] = {EXPAND_QUADRATIC, EXPAND_ALL, EXPAND_NONE};
  if (has_to_save_work(display)) return NULL;
  Node reduced = simplify_fraction(display->graph, node);
  char *best = NULL;
  double least = INFINITY;
  for (int i = 0; i < (reduced != node ? 6 : 3); i++) {
    double weight;
    char *text = text_of_form(display, i < 3 ? node : reduced, expansions[i % 3], is_whole, &weight);
    double length = text != NULL ? weight * (double)strlen(text) : INFINITY;
    if (length >= least) continue;
    best = text;
    least = length;
  }
  return best;
}

static const char *text_inside(struct Display *display, Node node) {
  if (node >= display->known_count) {
    size_t count = display->known_count;
    display->known_count = 2 * (size_t)node + 64;
    display->known = reallocate(display->known, display->known_count, sizeof(char *));
    memset(display->known + count, 0, (display->known_count - count) * sizeof(char *));
  }
  static char too_long[] = "";
  if (display->known[node] == NULL) {
    display->known[node] = too_long; /* also ends the recursion where a form of the node contains the node itself */
    display->depth++;
    char *text = display->depth <= DEPTH_LIMIT ? shortest_text(display, node, false) : NULL;
    display->depth--;
    display->known[node] = text != NULL && strlen(text) <= LENGTH_LIMIT ? text : too_long;
  }
  return display->known[node] != too_long ? display->known[node] : NULL;
}

Node display_node(struct Display *display, Node node) {
  struct Atoms atoms = {.graph = display->graph, .names = display->names, .whole = node, .expansion = EXPAND_ALL};
  struct Terms terms = terms_of_expression(&atoms, node);
  apply_addition_theorems(&atoms, &terms);
  Node sum = atoms.is_full ? node : node_of_terms(&atoms, &terms);
  release(terms.items);
  return sum;
}

char *display_text(struct Display *display, Node node) {
  char *text = shortest_text(display, node, true);
  return text != NULL ? text : expression_text_with_names(display->graph, node, display->names);
}
