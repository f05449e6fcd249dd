#include "algebra/simplify.h"

#include <float.h>
#include <math.h>

#include "algebra/functions.h"
#include "algebra/growth.h"

static const struct Vertex *vertex_of(const struct Graph *graph, Node node) {
  return &graph->vertices[node];
}

static bool is_whole(double value) {
  return value == floor(value) && fabs(value) < 1e9;
}

/* Returns the exponent of a POWER node if it is a number, else NAN. */
static double numeric_exponent(const struct Graph *graph, const struct Vertex *vertex) {
  return graph_is_constant(graph, vertex->right) ? graph_value(graph, vertex->right) : NAN;
}

double coefficient_of(const struct Graph *graph, Node node, Node *base) {
  const struct Vertex *vertex = vertex_of(graph, node);
  *base = node;
  if (vertex->operation == CONSTANT) {
    *base = ONE;
    return vertex->value;
  }
  if (vertex->operation == MULTIPLY && graph_is_constant(graph, vertex->left)) {
    *base = vertex->right;
    return graph_value(graph, vertex->left);
  }
  return 1.0;
}

Node scale(struct Graph *graph, double factor, Node node) {
  Node base;
  factor *= coefficient_of(graph, node, &base);
  if (base == ONE || factor == 0.0) return graph_constant(graph, factor);
  return factor == 1.0 ? base : graph_node(graph, MULTIPLY, graph_constant(graph, factor), base);
}

static int insert_factor(struct Factor factors[FACTOR_LIMIT], int count, Node base, double exponent) {
  int index = 0;
  while (index < count && factors[index].base < base) index++;
  if (index < count && factors[index].base == base) {
    factors[index].exponent += exponent;
    return count;
  }
  if (count == FACTOR_LIMIT) return -1;
  for (int i = count; i > index; i--) factors[i] = factors[i - 1];
  factors[index] = (struct Factor){base, exponent};
  return count + 1;
}

/* Most MULTIPLY nodes visited in a search for factors. Bounds its time and its recursion. */
enum { PRODUCT_LIMIT = 4 * FACTOR_LIMIT };

static int collect_factors(const struct Graph *graph, Node node, double exponent, struct Factor *factors, int count,
                           int *products) {
  const struct Vertex *vertex = vertex_of(graph, node);
  while (count >= 0 && vertex->operation == MULTIPLY) {
    if (++*products > PRODUCT_LIMIT) return -1;
    count = collect_factors(graph, vertex->left, exponent, factors, count, products);
    node = vertex->right;
    vertex = vertex_of(graph, node);
  }
  if (count < 0 || node == ONE) return count;
  if (vertex->operation == POWER) {
    double inner = numeric_exponent(graph, vertex);
    if (is_whole(inner)) return collect_factors(graph, vertex->left, exponent * inner, factors, count, products);
    if (!isnan(inner) && is_whole(exponent)) return insert_factor(factors, count, vertex->left, exponent * inner);
  }
  return insert_factor(factors, count, node, exponent);
}

int factors_of(const struct Graph *graph, Node node, struct Factor factors[FACTOR_LIMIT]) {
  Node base;
  coefficient_of(graph, node, &base);
  int products = 0;
  return collect_factors(graph, base, 1.0, factors, 0, &products);
}

Node product_of(struct Graph *graph, const struct Factor *factors, int count) {
  Node product = ONE;
  for (int sign = 1; sign >= -1; sign -= 2) {
    for (int i = 0; i < count; i++) {
      if (factors[i].exponent * sign <= 0) continue;
      Node factor = power_number(graph, factors[i].base, factors[i].exponent);
      product = product == ONE ? factor : graph_node(graph, MULTIPLY, product, factor);
    }
  }
  return product;
}

/* True if the products have a common base with exponents of opposite sign. */
static bool cancels(const struct Factor *left, int left_count, const struct Factor *right, int right_count) {
  for (int i = 0, j = 0; i < left_count && j < right_count;) {
    if (left[i].base == right[j].base && left[i].exponent * right[j].exponent < 0) return true;
    if (left[i].base < right[j].base) i++;
    else j++;
  }
  return false;
}

static Node multiply_bases(struct Graph *graph, Node left, Node right) {
  if (left == ONE) return right;
  if (right == ONE) return left;
  struct Factor a[FACTOR_LIMIT], b[FACTOR_LIMIT];
  int a_count = factors_of(graph, left, a), b_count = factors_of(graph, right, b);
  Node bounded;
  if (bounded_product(graph, a, a_count, b, b_count, &bounded)) return bounded;
  bool powers = a_count == 1 && b_count == 1 && a[0].base == b[0].base;
  if (a_count > 0 && b_count > 0 && (powers || cancels(a, a_count, b, b_count))) {
    int count = a_count;
    for (int i = 0; i < b_count && count >= 0; i++) count = insert_factor(a, count, b[i].base, b[i].exponent);
    if (count >= 0) return product_of(graph, a, count);
  }
  if (left == right) return power_number(graph, left, 2.0);
  return left < right ? graph_node(graph, MULTIPLY, left, right) : graph_node(graph, MULTIPLY, right, left);
}

Node multiply(struct Graph *graph, Node left, Node right) {
  Node a, b;
  double coefficient = coefficient_of(graph, left, &a) * coefficient_of(graph, right, &b);
  if (coefficient == 0.0) return ZERO;
  return scale(graph, coefficient, multiply_bases(graph, a, b));
}

Node divide(struct Graph *graph, Node left, Node right) {
  return multiply(graph, left, power_number(graph, right, -1.0));
}

Node negate(struct Graph *graph, Node node) {
  return scale(graph, -1.0, node);
}

Node power_number(struct Graph *graph, Node base, double exponent) {
  return power(graph, base, graph_constant(graph, exponent));
}

/* True if a real value of the node is never negative. */
static bool is_never_negative(const struct Graph *graph, Node node) {
  const struct Vertex *vertex = vertex_of(graph, node);
  double n = vertex->operation == POWER ? numeric_exponent(graph, vertex) : NAN;
  return functions[vertex->operation].is_never_negative || fmod(n, 2.0) == 0.0 || (!isnan(n) && !is_whole(n));
}

/*
 * Rewrites a root of a product with even powers: (u^2 w)^n = |u|^(2 n) w^n for an n that is not whole; |u| is u if 2 n
 * is even. False if the base has no even power.
 */
static bool root_of_even_powers(struct Graph *graph, Node base, double n, Node *result) {
  Node bare;
  struct Factor factors[FACTOR_LIMIT];
  double coefficient = coefficient_of(graph, base, &bare);
  int count = factors_of(graph, base, factors), rest = 0;
  Node outside = ONE;
  for (int i = 0; i < count && coefficient > 0.0; i++) {
    double exponent = factors[i].exponent * n;
    if (fmod(factors[i].exponent, 2.0) != 0.0) factors[rest++] = factors[i];
    else {
      bool is_even = fmod(exponent, 2.0) == 0.0;
      Node inner = is_even ? factors[i].base : function(graph, ABSOLUTE, factors[i].base, ZERO);
      outside = multiply(graph, outside, power_number(graph, inner, exponent));
    }
  }
  if (coefficient <= 0.0 || count <= 0 || rest == count) return false;
  Node inside = scale(graph, coefficient, product_of(graph, factors, rest));
  *result = multiply(graph, outside, power_number(graph, inside, n));
  return true;
}

Node power(struct Graph *graph, Node base, Node exponent) {
  if (base == ONE) return ONE;
  if (!graph_is_constant(graph, exponent)) return graph_node(graph, POWER, base, exponent);
  double n = graph_value(graph, exponent);
  if (n == 0.0) return ONE;
  if (n == 1.0) return base;
  if (graph_is_constant(graph, base)) return graph_constant(graph, pow(graph_value(graph, base), n));
  Node bounded;
  if (n < 0.0 && bounded_power(graph, base, n, &bounded)) return bounded;
  const struct Vertex vertex = *vertex_of(graph, base);
  if (is_whole(n)) {
    if (vertex.operation == POWER && !isnan(numeric_exponent(graph, &vertex)))
      return power_number(graph, vertex.left, n * numeric_exponent(graph, &vertex));
    if (vertex.operation == ABSOLUTE && fmod(n, 2.0) == 0.0) return power(graph, vertex.left, exponent);
    Node bare;
    double coefficient = coefficient_of(graph, base, &bare);
    if (coefficient != 1.0) return scale(graph, pow(coefficient, n), power(graph, bare, exponent));
  } else {
    Node result;
    if (root_of_even_powers(graph, base, n, &result)) return result;
  }
  return graph_node(graph, POWER, base, exponent);
}

int terms_of(const struct Graph *graph, Node node, Node *terms, int limit) {
  int count = 1, done = 0;
  terms[0] = node;
  while (done < count && count < limit) {
    const struct Vertex *vertex = vertex_of(graph, terms[done]);
    if (vertex->operation != ADD) {
      done++;
      continue;
    }
    for (int i = count; i > done + 1; i--) terms[i] = terms[i - 1];
    terms[done] = vertex->left;
    terms[done + 1] = vertex->right;
    count++;
  }
  return count;
}

/* A term of a sum: coefficient times factors, which are ascending by base. factor_count is -1 for too many. */
struct SumTerm {
  Node node;
  double coefficient;
  struct Factor factors[FACTOR_LIMIT];
  int factor_count;
};

static struct SumTerm term_of(const struct Graph *graph, Node node) {
  struct SumTerm term = {.node = node};
  Node base;
  term.coefficient = coefficient_of(graph, node, &base);
  term.factor_count = vertex_of(graph, node)->operation == ADD ? -1 : factors_of(graph, node, term.factors);
  return term;
}

/* Removes the factors that both terms have from both. Returns their number. */
static int common_factors(struct SumTerm *a, struct SumTerm *b, struct Factor *common) {
  int count = 0, a_count = 0, b_count = 0, i = 0, j = 0;
  while (i < a->factor_count || j < b->factor_count) {
    bool only_a = j == b->factor_count || (i < a->factor_count && a->factors[i].base < b->factors[j].base);
    bool only_b = i == a->factor_count || (j < b->factor_count && b->factors[j].base < a->factors[i].base);
    if (only_a) a->factors[a_count++] = a->factors[i++];
    else if (only_b) b->factors[b_count++] = b->factors[j++];
    else {
      Node base = a->factors[i].base;
      double p = a->factors[i++].exponent, q = b->factors[j++].exponent, least = fmin(p, q);
      common[count++] = (struct Factor){base, least};
      if (p > least) a->factors[a_count++] = (struct Factor){base, p - least};
      if (q > least) b->factors[b_count++] = (struct Factor){base, q - least};
    }
  }
  a->factor_count = a_count;
  b->factor_count = b_count;
  return count;
}

/* True if the term is sin(u)^2 or cos(u)^2; returns which one, and u. */
static bool is_square_of(const struct Graph *graph, const struct SumTerm *term, enum Operation *operation,
                         Node *angle) {
  if (term->factor_count != 1 || term->factors[0].exponent != 2.0) return false;
  const struct Vertex *vertex = vertex_of(graph, term->factors[0].base);
  *operation = vertex->operation;
  *angle = vertex->left;
  return *operation == SINE || *operation == COSINE;
}

/* Returns a + b; 0 where they cancel but for their rounding, as weights of a quadrature do. */
static double sum_of_coefficients(double a, double b) {
  double sum = a + b;
  return fabs(sum) > 32.0 * DBL_EPSILON * fabs(a) ? sum : 0.0;
}

/* Combines a + b into one term, by equal factors, sin^2 + cos^2 = 1 or 1 - sin^2 = cos^2. False if none applies. */
static bool combine(struct Graph *graph, struct SumTerm a, struct SumTerm b, Node *result) {
  if (a.factor_count < 0 || b.factor_count < 0) return false;
  struct Factor common[2 * FACTOR_LIMIT];
  int count = common_factors(&a, &b, common);
  enum Operation first = ADD, second = ADD;
  Node u = ZERO, w = ZERO, rest;
  bool a_square = is_square_of(graph, &a, &first, &u), b_square = is_square_of(graph, &b, &second, &w);
  if (a.factor_count == 0 && b.factor_count == 0) {
    rest = product_of(graph, common, count);
    *result = scale(graph, sum_of_coefficients(a.coefficient, b.coefficient), rest);
    return true;
  }
  bool is_one_each = a.factor_count == 1 && b.factor_count == 1 && a.coefficient == b.coefficient;
  if (is_one_each && a.factors[0].exponent == 1.0 && b.factors[0].exponent == 1.0 &&
      are_complements(graph, a.factors[0].base, b.factors[0].base)) {
    *result = scale(graph, a.coefficient, product_of(graph, common, count));
    return true;
  }
  if (a_square && b_square && u == w && first != second && a.coefficient == b.coefficient) {
    *result = scale(graph, a.coefficient, product_of(graph, common, count));
    return true;
  }
  if (a.coefficient != -b.coefficient || a.factor_count + b.factor_count != 1 || !(a_square || b_square)) return false;
  Node other = graph_node(graph, (a_square ? first : second) == SINE ? COSINE : SINE, a_square ? u : w, ZERO);
  Node square = power_number(graph, other, 2.0);
  rest = multiply(graph, product_of(graph, common, count), square);
  *result = scale(graph, a_square ? b.coefficient : a.coefficient, rest);
  return true;
}

static Node sum(struct Graph *graph, Node left, Node right) {
  if (left == ZERO) return right;
  if (right == ZERO) return left;
  return left < right ? graph_node(graph, ADD, left, right) : graph_node(graph, ADD, right, left);
}

Node add(struct Graph *graph, Node left, Node right) {
  if (left == ZERO) return right;
  if (right == ZERO) return left;
  Node a[TERM_LIMIT], b[TERM_LIMIT];
  struct SumTerm a_terms[TERM_LIMIT], b_terms[TERM_LIMIT];
  int a_count = terms_of(graph, left, a, TERM_LIMIT), b_count = terms_of(graph, right, b, TERM_LIMIT);
  for (int i = 0; i < a_count; i++) a_terms[i] = term_of(graph, a[i]);
  for (int i = 0; i < b_count; i++) b_terms[i] = term_of(graph, b[i]);
  for (int i = 0; i < a_count; i++) {
    for (int j = 0; j < b_count; j++) {
      Node combined;
      if (!combine(graph, a_terms[i], b_terms[j], &combined)) continue;
      Node result = ZERO;
      for (int k = 0; k < a_count; k++)
        if (k != i) result = sum(graph, result, a[k]);
      for (int k = 0; k < b_count; k++)
        if (k != j) result = add(graph, result, b[k]);
      return add(graph, result, combined);
    }
  }
  return sum(graph, left, right);
}

Node add_whole(struct Graph *graph, Node left, Node right) {
  if (graph_is_constant(graph, left) && graph_is_constant(graph, right)) return add(graph, left, right);
  if (left == right) return scale(graph, 2.0, left);
  return right == negate(graph, left) ? ZERO : sum(graph, left, right);
}

Node subtract(struct Graph *graph, Node left, Node right) {
  return add(graph, left, negate(graph, right));
}

/* Simplifies guards: a constant condition removes one, and the guard of a guarded 1 uses its condition. */
static Node guard(struct Graph *graph, Node guard_condition, Node node) {
  const struct Vertex *vertex = &graph->vertices[guard_condition];
  if (graph_is_constant(graph, guard_condition)) return graph_value(graph, guard_condition) > 0.0 ? node : ZERO;
  if (node == ZERO) return ZERO;
  if (vertex->operation == GUARD && vertex->right == ONE) guard_condition = vertex->left;
  return graph_node(graph, GUARD, guard_condition, node);
}

/* True for functions that are constant to rounding for large arguments, or overflow. */
static bool is_constant_far_out(enum Operation operation) {
  return operation == EXPONENTIAL || operation == TANH || operation == ARCTANGENT || operation == LOGISTIC ||
         operation == SECH;
}

Node function(struct Graph *graph, enum Operation operation, Node left, Node right) {
  if (operation_arity(operation) == 1) right = ZERO;
  if (graph_is_constant(graph, left) && graph_is_constant(graph, right))
    return graph_constant(graph, operation_evaluate(operation, graph_value(graph, left), graph_value(graph, right)));
  if ((operation == MINIMUM || operation == MAXIMUM) && left == right) return left;
  if (operation == ABSOLUTE && is_never_negative(graph, left)) return left;
  if (operation == GUARD) return guard(graph, left, right);
  Node base;
  if (operation == LOGARITHM && bounded_logarithm(graph, left, &base)) return base;
  if (is_constant_far_out(operation) && bounded_argument(graph, left, &base)) left = base;
  if (coefficient_of(graph, left, &base) < 0) {
    enum Parity parity = functions[operation].parity;
    if (parity == ODD) return negate(graph, graph_node(graph, operation, negate(graph, left), right));
    if (parity == EVEN) return graph_node(graph, operation, negate(graph, left), right);
  }
  return graph_node(graph, operation, left, right);
}

Node choose_node(struct Graph *graph, Node condition, Node positive, Node other) {
  Node is_positive = function(graph, GUARD, condition, ONE);
  Node chosen = function(graph, GUARD, condition, positive);
  return add(graph, chosen, function(graph, GUARD, subtract(graph, ONE, is_positive), other));
}
