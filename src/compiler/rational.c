#include "rational.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "polynomial.h"
#include "simplify.h"

struct Fraction {
  struct Polynomial above, below;
};

struct Converter {
  struct Graph *graph;
  Node atoms[ATOM_LIMIT];
  int atom_count;
  bool overflow;
};

static void fraction_free(struct Fraction *fraction) {
  polynomial_free(&fraction->above);
  polynomial_free(&fraction->below);
}

static struct Fraction fraction_copy(const struct Fraction *fraction) {
  return (struct Fraction){polynomial_copy(&fraction->above), polynomial_copy(&fraction->below)};
}

/* Replaces a and b by their quotient and 1 where one divides the other. */
static void cancel_polynomials(struct Polynomial *a, struct Polynomial *b) {
  struct Polynomial quotient;
  bool below = polynomial_divide(a, b, &quotient);
  if (!below && !polynomial_divide(b, a, &quotient)) return;
  polynomial_free(a);
  polynomial_free(b);
  *a = below ? quotient : polynomial_constant(1.0);
  *b = below ? polynomial_constant(1.0) : quotient;
}

static void fraction_reduce(struct Fraction *fraction) {
  struct Polynomial *above = &fraction->above, *below = &fraction->below;
  if (above->overflow || below->overflow || below->count == 0) return;
  if (above->count == 0) {
    polynomial_free(below);
    *below = polynomial_constant(1.0);
    return;
  }
  uint8_t a[ATOM_LIMIT], b[ATOM_LIMIT];
  polynomial_take_content(above, a);
  polynomial_take_content(below, b);
  for (int atom = 0; atom < ATOM_LIMIT; atom++) {
    uint8_t common = a[atom] < b[atom] ? a[atom] : b[atom];
    a[atom] = (uint8_t)(a[atom] - common);
    b[atom] = (uint8_t)(b[atom] - common);
  }
  cancel_polynomials(above, below);
  double lead = below->terms[0].coefficient;
  polynomial_scale(above, 1.0 / lead, a);
  polynomial_scale(below, 1.0 / lead, b);
}

static struct Fraction fraction_add(const struct Fraction *x, const struct Fraction *y) {
  struct Polynomial left = polynomial_multiply(&x->above, &y->below);
  struct Polynomial right = polynomial_multiply(&y->above, &x->below);
  struct Fraction sum = {polynomial_add(&left, &right, 1.0), polynomial_multiply(&x->below, &y->below)};
  polynomial_free(&left);
  polynomial_free(&right);
  fraction_reduce(&sum);
  return sum;
}

static struct Fraction fraction_multiply(const struct Fraction *x, const struct Fraction *y) {
  struct Fraction product = {polynomial_multiply(&x->above, &y->above),
                             polynomial_multiply(&x->below, &y->below)};
  fraction_reduce(&product);
  return product;
}

static struct Fraction atom_fraction(struct Converter *converter, Node node) {
  int atom = 0;
  while (atom < converter->atom_count && converter->atoms[atom] != node) atom++;
  if (atom == ATOM_LIMIT) {
    converter->overflow = true;
    atom = 0;
  } else if (atom == converter->atom_count) converter->atoms[converter->atom_count++] = node;
  return (struct Fraction){polynomial_atom(atom), polynomial_constant(1.0)};
}

static struct Fraction fraction_power(const struct Fraction *x, int exponent) {
  struct Fraction result = {polynomial_constant(1.0), polynomial_constant(1.0)};
  struct Fraction base = fraction_copy(x);
  if (exponent < 0) base = (struct Fraction){base.below, base.above};
  for (int i = abs(exponent); i > 0; i--) {
    struct Fraction next = fraction_multiply(&result, &base);
    fraction_free(&result);
    result = next;
  }
  fraction_free(&base);
  return result;
}

static struct Fraction convert(struct Converter *converter, Node node, const struct Fraction *known) {
  const struct Vertex *vertex = &converter->graph->vertices[node];
  switch (vertex->operation) {
  case CONSTANT: return (struct Fraction){polynomial_constant(vertex->value), polynomial_constant(1.0)};
  case ADD: return fraction_add(&known[vertex->left], &known[vertex->right]);
  case MULTIPLY: return fraction_multiply(&known[vertex->left], &known[vertex->right]);
  case POWER: {
    double exponent =
        graph_is_constant(converter->graph, vertex->right) ? graph_value(converter->graph, vertex->right) : NAN;
    bool invertible = exponent > 0 || known[vertex->left].above.count > 0;
    if (exponent == floor(exponent) && fabs(exponent) <= 20 && invertible)
      return fraction_power(&known[vertex->left], (int)exponent);
    return atom_fraction(converter, node);
  }
  default: return atom_fraction(converter, node);
  }
}

static Node monomial_node(const struct Converter *converter, double coefficient,
                          const uint8_t exponent[ATOM_LIMIT]) {
  struct Graph *graph = converter->graph;
  Node product = ONE;
  for (int atom = 0; atom < converter->atom_count; atom++)
    if (exponent[atom] > 0)
      product = multiply(graph, product, power_number(graph, converter->atoms[atom], exponent[atom]));
  return scale(graph, coefficient, product);
}

static Node polynomial_node(const struct Converter *converter, struct Polynomial *p) {
  uint8_t content[ATOM_LIMIT];
  polynomial_take_content(p, content);
  double lead = p->count > 0 ? p->terms[p->count - 1].coefficient : 1.0;
  bool divisible = true;
  for (size_t i = 0; i < p->count; i++) {
    double ratio = p->terms[i].coefficient / lead;
    divisible = divisible && ratio == floor(ratio);
  }
  if (!divisible) lead = 1.0;
  Node sum = ZERO;
  for (size_t i = 0; i < p->count; i++)
    sum = add(converter->graph, sum,
              monomial_node(converter, p->terms[i].coefficient / lead, p->terms[i].exponent));
  return multiply(converter->graph, monomial_node(converter, lead, content), sum);
}

Node simplify_fraction(struct Graph *graph, Node node) {
  struct Converter converter = {.graph = graph};
  bool *needed = allocate(graph->count, sizeof *needed);
  struct Fraction *known = allocate((size_t)node + 1, sizeof *known);
  graph_mark(graph, &node, 1, needed);
  for (Node i = 0; i <= node && !converter.overflow; i++) {
    if (!needed[i]) continue;
    known[i] = convert(&converter, i, known);
    converter.overflow = converter.overflow || known[i].above.overflow || known[i].below.overflow ||
                         known[i].below.count == 0;
  }
  Node result = node;
  if (!converter.overflow)
    result = divide(graph, polynomial_node(&converter, &known[node].above),
                    polynomial_node(&converter, &known[node].below));
  for (Node i = 0; i <= node; i++) fraction_free(&known[i]);
  free(known);
  free(needed);
  return result;
}
