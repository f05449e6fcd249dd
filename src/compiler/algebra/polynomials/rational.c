#include "algebra/polynomials/rational.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "algebra/cone.h"
#include "algebra/polynomials/polynomial.h"
#include "algebra/simplify.h"
#include "base/memory.h"

/* above / below, reduced; below is not 0. */
struct Fraction {
  struct Polynomial above, below;
};

/* The indeterminates of a conversion: atom i of polynomials is the node atoms[i]. */
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

/* Cancels b from a, or a from b, if one divides the other. Single monomials have no common factor here. */
static void cancel_polynomials(struct Polynomial *a, struct Polynomial *b) {
  struct Polynomial quotient;
  if (a->count == 1 || b->count == 1) return;
  bool below = polynomial_divide(a, b, &quotient);
  if (!below && !polynomial_divide(b, a, &quotient)) return;
  polynomial_free(a);
  polynomial_free(b);
  *a = below ? quotient : polynomial_constant(1.0);
  *b = below ? polynomial_constant(1.0) : quotient;
}

/* Returns the greatest common divisor of whole numbers, by Euclid's algorithm. */
static double greatest_common_divisor(double a, double b) {
  while (b != 0.0) {
    double rest = fmod(a, b);
    a = b;
    b = rest;
  }
  return fabs(a);
}

/*
 * Returns the number by which all coefficients are divided. If they are multiples of 1/1024, the results are whole
 * numbers without a common divisor, so that rational coefficients stay exact. Else the denominator gets the leading
 * coefficient 1.
 */
static double common_divisor(const struct Polynomial *above, const struct Polynomial *below) {
  const struct Polynomial *const parts[] = {above, below};
  const double fraction = 1.0 / 1024, lead = below->terms[0].coefficient;
  double divisor = 0.0;
  for (int part = 0; part < 2; part++) {
    for (size_t i = 0; i < parts[part]->count; i++) {
      double whole = parts[part]->terms[i].coefficient / fraction;
      if (whole != floor(whole) || fabs(whole) > 1e15) return lead;
      divisor = greatest_common_divisor(divisor, whole);
    }
  }
  return lead < 0 ? -divisor * fraction : divisor * fraction;
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
  double divisor = common_divisor(above, below);
  polynomial_divide_by(above, divisor, a);
  polynomial_divide_by(below, divisor, b);
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
  struct Fraction product = {polynomial_multiply(&x->above, &y->above), polynomial_multiply(&x->below, &y->below)};
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

/* Returns the fraction of a node; known holds those of the nodes below, by their positions in the cone. */
static struct Fraction convert(struct Converter *converter, Node node, const struct Fraction *known) {
  const struct Cone *cone = converter->graph->cone;
  const struct Vertex *vertex = &converter->graph->vertices[node];
  switch (vertex->operation) {
  case CONSTANT: return (struct Fraction){polynomial_constant(vertex->value), polynomial_constant(1.0)};
  case ADD: return fraction_add(&known[cone_slot(cone, vertex->left)], &known[cone_slot(cone, vertex->right)]);
  case MULTIPLY:
    return fraction_multiply(&known[cone_slot(cone, vertex->left)], &known[cone_slot(cone, vertex->right)]);
  case POWER: {
    double exponent =
        graph_is_constant(converter->graph, vertex->right) ? graph_value(converter->graph, vertex->right) : NAN;
    const struct Fraction *base = &known[cone_slot(cone, vertex->left)];
    bool invertible = exponent > 0 || base->above.count > 0;
    if (exponent == floor(exponent) && fabs(exponent) <= 20 && invertible) return fraction_power(base, (int)exponent);
    return atom_fraction(converter, node);
  }
  default: return atom_fraction(converter, node);
  }
}

static Node monomial_node(const struct Converter *converter, double coefficient, const uint8_t exponent[ATOM_LIMIT]) {
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
    sum = add(converter->graph, sum, monomial_node(converter, p->terms[i].coefficient / lead, p->terms[i].exponent));
  return multiply(converter->graph, monomial_node(converter, lead, content), sum);
}

static bool is_usable(const struct Fraction *fraction) {
  return !fraction->above.overflow && !fraction->below.overflow && fraction->below.count > 0;
}

static void note_large(struct Graph *graph, Node node) {
  size_t count = graph->large_count;
  if (node >= count) {
    graph->large_count = 2 * graph->count;
    graph->is_large = reallocate(graph->is_large, graph->large_count, sizeof *graph->is_large);
    memset(graph->is_large + count, 0, (graph->large_count - count) * sizeof *graph->is_large);
  }
  graph->is_large[node] = true;
}

/*
 * Ends the collection of an expression that is too large, before it is expanded. Such an expression has more than
 * ATOM_LIMIT symbols and functions, or contains a node that was found too large.
 */
static enum Visit visit_while_small(void *atoms, const struct Graph *graph, Node node) {
  enum Operation operation = graph->vertices[node].operation;
  *(int *)atoms += operation != CONSTANT && operation != ADD && operation != MULTIPLY && operation != POWER;
  bool is_large = *(int *)atoms > ATOM_LIMIT || (node < graph->large_count && graph->is_large[node]);
  return is_large ? VISIT_NO_MORE : VISIT_OPERANDS;
}

/* Returns the steps of graph_work() for a node: products and quotients combine all pairs of terms. */
static size_t work_of(const struct Graph *graph, const struct Fraction *known, size_t index) {
  const struct Cone *cone = graph->cone;
  const struct Vertex *vertex = &graph->vertices[cone->nodes[index]];
  const struct Fraction *result = &known[index];
  size_t terms = result->above.count + result->below.count;
  if (result->below.count > 1 || vertex->operation == POWER) return terms * terms;
  if (vertex->operation != MULTIPLY) return terms;
  const struct Fraction *left = &known[cone_slot(cone, vertex->left)], *right = &known[cone_slot(cone, vertex->right)];
  return terms + left->above.count * right->above.count;
}

/* Converts nodes, and all nodes below them, to fractions. False if they are too large. */
static bool convert_all(struct Converter *converter, const Node *nodes, size_t count, struct Fraction *fractions) {
  struct Cone *cone = converter->graph->cone;
  int atoms = 0;
  if (!cone_collect_part(cone, converter->graph, nodes, count, visit_while_small, &atoms)) return false;
  struct Fraction *known = allocate(cone->count, sizeof *known);
  for (size_t index = 0; index < cone->count && !converter->overflow; index++) {
    known[index] = convert(converter, cone->nodes[index], known);
    graph_work(converter->graph, work_of(converter->graph, known, index));
    if (!is_usable(&known[index])) {
      note_large(converter->graph, cone->nodes[index]);
      converter->overflow = true;
    }
  }
  for (size_t i = 0; i < count && !converter->overflow; i++)
    fractions[i] = fraction_copy(&known[cone_slot(cone, nodes[i])]);
  for (size_t index = 0; index < cone->count; index++) fraction_free(&known[index]);
  release(known);
  return !converter->overflow;
}

static Node fraction_node(const struct Converter *converter, struct Fraction *fraction) {
  Node above = polynomial_node(converter, &fraction->above), below = polynomial_node(converter, &fraction->below);
  return divide(converter->graph, above, below);
}

Node simplify_fraction(struct Graph *graph, Node node) {
  struct Converter converter = {.graph = graph};
  struct Fraction fraction = {0};
  if (graph_limit(graph) != NULL) return node;
  Node result = convert_all(&converter, &node, 1, &fraction) ? fraction_node(&converter, &fraction) : node;
  fraction_free(&fraction);
  return result;
}

/* Replaces x by x - factor * y. */
static void fraction_subtract(struct Fraction *x, const struct Fraction *factor, const struct Fraction *y) {
  struct Fraction product = fraction_multiply(factor, y);
  for (size_t i = 0; i < product.above.count; i++) product.above.terms[i].coefficient *= -1.0;
  struct Fraction difference = fraction_add(x, &product);
  fraction_free(&product);
  fraction_free(x);
  *x = difference;
}

/* Makes Gauss-Jordan elimination of n rows, matrix and right sides, with diagonal pivots. False if a pivot is 0. */
static bool eliminate(size_t n, size_t width, struct Fraction *rows) {
  for (size_t k = 0; k < n; k++) {
    struct Fraction *pivot_row = rows + k * width;
    if (pivot_row[k].above.count == 0) return false;
    struct Fraction inverse = fraction_power(&pivot_row[k], -1);
    for (size_t j = k; j < width; j++) {
      struct Fraction scaled = fraction_multiply(&pivot_row[j], &inverse);
      fraction_free(&pivot_row[j]);
      pivot_row[j] = scaled;
    }
    fraction_free(&inverse);
    for (size_t i = 0; i < n; i++) {
      struct Fraction *row = rows + i * width, factor = fraction_copy(&row[k]);
      bool usable = true;
      for (size_t j = k; j < width && i != k && factor.above.count > 0; j++) {
        fraction_subtract(&row[j], &factor, &pivot_row[j]);
        usable = usable && is_usable(&row[j]);
      }
      fraction_free(&factor);
      if (!usable) return false;
    }
  }
  return true;
}

bool solve_fractions(struct Graph *graph, size_t n, const Node *matrix, size_t columns, const Node *right,
                     Node *solution) {
  size_t width = n + columns;
  struct Converter converter = {.graph = graph};
  Node *nodes = allocate(n * width, sizeof *nodes);
  struct Fraction *rows = allocate(n * width, sizeof *rows);
  for (size_t i = 0; i < n; i++) {
    for (size_t j = 0; j < n; j++) nodes[i * width + j] = matrix[i * n + j];
    for (size_t j = 0; j < columns; j++) nodes[i * width + n + j] = right[i * columns + j];
  }
  bool solved = convert_all(&converter, nodes, n * width, rows) && eliminate(n, width, rows);
  for (size_t i = 0; i < n && solved; i++)
    for (size_t j = 0; j < columns; j++)
      solution[i * columns + j] = fraction_node(&converter, &rows[i * width + n + j]);
  for (size_t i = 0; i < n * width; i++) fraction_free(&rows[i]);
  release(rows);
  release(nodes);
  return solved;
}
