#include "display/terms.h"

#include <math.h>
#include <string.h>

#include "algebra/simplify.h"
#include "base/memory.h"

/*
 * Most visits to nodes of one expression, the deepest recursion, which bounds the stack, and the highest power of a sum
 * that is multiplied out.
 */
enum { VISIT_LIMIT = 4000, DEPTH_LIMIT = 250, POWER_LIMIT = 4 };

/* Coefficients whose sum is smaller than this share of the largest partial sum cancel but for rounding. */
static const double cancellation = 1e-14;

const char *displayed_name(const struct Atoms *atoms, Node node) {
  bool is_named = node != atoms->whole && (size_t)node < atoms->names->count;
  return is_named ? atoms->names->of[node] : NULL;
}

int atom_index(struct Atoms *atoms, Node node) {
  int i = 0;
  while (i < atoms->count && atoms->nodes[i] != node) i++;
  if (i == ATOM_ROOM) {
    atoms->is_full = true;
    return 0;
  }
  if (i == atoms->count) atoms->nodes[atoms->count++] = node;
  return i;
}

bool have_equal_atoms(const struct Term *a, const struct Term *b) {
  for (int i = 0; i < ATOM_ROOM; i++)
    if (a->exponents[i] != b->exponents[i]) return false;
  return true;
}

static double magnitude_of(const struct Term *term) {
  return fmax(term->magnitude, fabs(term->coefficient));
}

void add_to_terms(struct Atoms *atoms, struct Terms *terms, const struct Term *term) {
  for (size_t i = 0; i < terms->count; i++) {
    struct Term *other = &terms->items[i];
    if (!have_equal_atoms(other, term)) continue;
    other->magnitude = fmax(magnitude_of(other), magnitude_of(term));
    other->coefficient += term->coefficient;
    if (fabs(other->coefficient) <= cancellation * other->magnitude) *other = terms->items[--terms->count];
    return;
  }
  if (term->coefficient == 0.0) return;
  if (terms->count == TERM_ROOM) {
    atoms->is_full = true;
    return;
  }
  APPEND(terms->items, terms->count, *term);
}

static struct Terms single_term(struct Atoms *atoms, double coefficient) {
  struct Terms terms = {NULL, 0};
  add_to_terms(atoms, &terms, &(struct Term){.coefficient = coefficient});
  return terms;
}

/* Multiplies all terms by atom^exponent. */
static void multiply_by_atom(struct Atoms *atoms, struct Terms *terms, Node atom, double exponent) {
  int index = atom_index(atoms, atom);
  for (size_t i = 0; i < terms->count; i++) terms->items[i].exponents[index] += exponent;
}

static struct Terms product_of_terms(struct Atoms *atoms, const struct Terms *a, const struct Terms *b) {
  struct Terms product = {NULL, 0};
  for (size_t i = 0; i < a->count && !atoms->is_full; i++)
    for (size_t j = 0; j < b->count && !atoms->is_full; j++) {
      struct Term term = a->items[i];
      term.magnitude = magnitude_of(&term) * magnitude_of(&b->items[j]);
      term.coefficient *= b->items[j].coefficient;
      for (int k = 0; k < ATOM_ROOM; k++) term.exponents[k] += b->items[j].exponents[k];
      add_to_terms(atoms, &product, &term);
    }
  return product;
}

static void multiply_terms(struct Atoms *atoms, struct Terms *terms, const struct Terms *by) {
  struct Terms product = product_of_terms(atoms, terms, by);
  release(terms->items);
  *terms = product;
}

/* Multiplies all terms by the power of a single term. */
static void multiply_by_power(struct Terms *terms, const struct Term *base, double exponent) {
  for (size_t i = 0; i < terms->count; i++) {
    terms->items[i].coefficient *= pow(base->coefficient, exponent);
    for (int k = 0; k < ATOM_ROOM; k++) terms->items[i].exponents[k] += exponent * base->exponents[k];
  }
}

/* A factor base^exponent of a product, with the terms of the base. */
struct TermFactor {
  Node base;
  double exponent;
  struct Terms terms;
};

/* Returns the degree in velocities of the factor with the highest degree of its terms. */
static double velocity_degree(const struct Atoms *atoms, const struct TermFactor *factor) {
  double largest = 0.0;
  for (size_t i = 0; i < factor->terms.count; i++) {
    double degree = 0.0;
    for (int k = 0; k < atoms->count; k++)
      if (graph_depends_on(atoms->graph, atoms->nodes[k], VELOCITY)) degree += factor->terms.items[i].exponents[k];
    largest = fmax(largest, degree);
  }
  return largest * factor->exponent;
}

static bool is_whole(double exponent) {
  return exponent == floor(exponent);
}

/* True if a factor that is a sum is multiplied out, in a product of this degree in velocities. */
static bool is_expanded(const struct Atoms *atoms, const struct TermFactor *factor, double degree) {
  if (!is_whole(factor->exponent) || factor->exponent < 0.0 || factor->exponent > POWER_LIMIT) return false;
  if (atoms->expansion == EXPAND_ALL) return true;
  return atoms->expansion == EXPAND_QUADRATIC && degree >= 2.0 &&
         graph_depends_on(atoms->graph, factor->base, VELOCITY);
}

/* Replaces base^exponent by a power of a named expression, if it is one. */
static void use_named_root(const struct Atoms *atoms, struct TermFactor *factor) {
  const struct Graph *graph = atoms->graph;
  for (size_t i = 0; i < atoms->names->named_count; i++) {
    const struct Vertex *vertex = &graph->vertices[atoms->names->named[i]];
    if (vertex->operation != POWER || vertex->left != factor->base || !graph_is_constant(graph, vertex->right))
      continue;
    double multiple = factor->exponent / graph_value(graph, vertex->right);
    if (atoms->names->named[i] == atoms->whole || !is_whole(multiple) || multiple == 0.0) continue;
    factor->base = atoms->names->named[i];
    factor->exponent = multiple;
    return;
  }
}

static void multiply_by_factor(struct Atoms *atoms, struct Terms *terms, const struct TermFactor *factor,
                               bool expanded) {
  if (factor->terms.count == 1 && is_whole(factor->exponent))
    multiply_by_power(terms, &factor->terms.items[0], factor->exponent);
  else if (expanded)
    for (int i = 0; i < (int)factor->exponent; i++) multiply_terms(atoms, terms, &factor->terms);
  else multiply_by_atom(atoms, terms, factor->base, factor->exponent);
}

static struct Terms terms_of_product(struct Atoms *atoms, Node node) {
  struct Factor found[FACTOR_LIMIT];
  struct TermFactor factors[FACTOR_LIMIT];
  Node base;
  double coefficient = coefficient_of(atoms->graph, node, &base), degree = 0.0;
  bool is_named = base != node && displayed_name(atoms, base) != NULL;
  int count = is_named ? 1 : factors_of(atoms->graph, base, found);
  if (is_named) found[0] = (struct Factor){.base = base, .exponent = 1.0};
  if (count < 0) atoms->is_full = true;
  struct Terms terms = single_term(atoms, coefficient);
  for (int i = 0; i < count; i++) {
    factors[i] = (struct TermFactor){.base = found[i].base, .exponent = found[i].exponent};
    use_named_root(atoms, &factors[i]);
    if (factors[i].base == node) { /* a power of which the base is not known */
      multiply_by_atom(atoms, &terms, node, 1.0);
      return terms;
    }
    factors[i].terms = terms_of_expression(atoms, factors[i].base);
    degree += velocity_degree(atoms, &factors[i]);
  }
  bool is_negation = count == 1 && coefficient == -1.0,
       of_acceleration = graph_depends_on(atoms->graph, node, ACCELERATION);
  for (int i = 0; i < count && !atoms->is_full; i++) {
    bool always = (is_negation || of_acceleration) && factors[i].exponent == 1.0;
    multiply_by_factor(atoms, &terms, &factors[i], always || is_expanded(atoms, &factors[i], degree));
  }
  for (int i = 0; i < count; i++) release(factors[i].terms.items);
  return terms;
}

static struct Terms terms_of_sum(struct Atoms *atoms, Node node) {
  const struct Vertex sum = atoms->graph->vertices[node];
  struct Terms left = terms_of_expression(atoms, sum.left), right = terms_of_expression(atoms, sum.right);
  for (size_t i = 0; i < right.count; i++) add_to_terms(atoms, &left, &right.items[i]);
  release(right.items);
  return left;
}

/* Returns the terms of a node of which no limit is exceeded yet. */
static struct Terms terms_of_node(struct Atoms *atoms, Node node) {
  const struct Vertex *vertex = &atoms->graph->vertices[node];
  struct Conditional choice;
  if (displayed_name(atoms, node) == NULL && !choice_of(atoms->graph, node, &choice)) {
    if (vertex->operation == CONSTANT) return single_term(atoms, vertex->value);
    if (vertex->operation == ADD) return terms_of_sum(atoms, node);
    bool is_power = vertex->operation == POWER && graph_is_constant(atoms->graph, vertex->right);
    if (vertex->operation == MULTIPLY || is_power) return terms_of_product(atoms, node);
  }
  struct Terms terms = single_term(atoms, 1.0);
  multiply_by_atom(atoms, &terms, node, 1.0);
  return terms;
}

struct Terms terms_of_expression(struct Atoms *atoms, Node node) {
  if (++atoms->visits > VISIT_LIMIT || atoms->depth == DEPTH_LIMIT) atoms->is_full = true;
  if (atoms->is_full) return (struct Terms){NULL, 0};
  atoms->depth++;
  struct Terms terms = terms_of_node(atoms, node);
  atoms->depth--;
  return terms;
}

Node node_of_terms(const struct Atoms *atoms, const struct Terms *terms) {
  struct Graph *graph = atoms->graph;
  Node sum = ZERO;
  for (size_t i = 0; i < terms->count; i++) {
    Node product = ONE;
    for (int k = 0; k < atoms->count; k++)
      if (terms->items[i].exponents[k] != 0.0)
        product = multiply(graph, product, power_number(graph, atoms->nodes[k], terms->items[i].exponents[k]));
    sum = add(graph, sum, scale(graph, terms->items[i].coefficient, product));
  }
  return sum;
}
