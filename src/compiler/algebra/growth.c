#include "algebra/growth.h"

#include <math.h>

#include "algebra/functions.h"
#include "algebra/simplify.h"

/* exp(u), cosh(u) or sinh(u), to a power: u = coefficient base, with the power as part of the coefficient for exp. */
struct GrowingFactor {
  enum Operation operation;
  Node base;
  double coefficient, power;
};

/* A positive function that decays as fast as something grows: node^power. */
struct DecayingFactor {
  Node node; /* 1/(1 + exp(u)), 1/cosh(u) or exp(u) */
  double power;
};

static const struct Vertex *vertex_of(const struct Graph *graph, Node node) {
  return &graph->vertices[node];
}

/* Returns log(c) for a node c^u with a number c > 0; 0 for other nodes. */
static double logarithm_of_base(const struct Graph *graph, const struct Vertex *vertex) {
  bool is_power = vertex->operation == POWER && graph_is_constant(graph, vertex->left) &&
                  !graph_is_constant(graph, vertex->right) && graph_value(graph, vertex->left) > 0.0;
  return is_power ? log(graph_value(graph, vertex->left)) : 0.0;
}

static bool is_whole_from_1(double value) {
  return value == floor(value) && value >= 1.0 && value < 100.0;
}

/* True if a node is surely nonnegative: a sum or a product of even powers and of nonnegative functions. */
static bool is_never_negative(const struct Graph *graph, Node node) {
  Node base, terms[TERM_LIMIT];
  bool is_sum = vertex_of(graph, node)->operation == ADD;
  int term_count = is_sum ? terms_of(graph, node, terms, TERM_LIMIT) : 0;
  for (int i = 0; i < term_count; i++)
    if (vertex_of(graph, terms[i])->operation == ADD || !is_never_negative(graph, terms[i])) return false;
  if (is_sum) return true;
  if (coefficient_of(graph, node, &base) < 0.0) return false;
  struct Factor factors[FACTOR_LIMIT];
  int count = factors_of(graph, base, factors);
  for (int i = 0; i < count; i++) {
    bool is_known = fmod(factors[i].exponent, 2.0) == 0.0 ||
                    functions[vertex_of(graph, factors[i].base)->operation].is_never_negative;
    bool is_inner_sum = vertex_of(graph, factors[i].base)->operation == ADD;
    if (!is_known && !(is_inner_sum && is_never_negative(graph, factors[i].base))) return false;
  }
  return count >= 0;
}

/* True for cosh and sinh to whole powers, and for exp if its argument may be positive. Sets growth. */
static bool grows(const struct Graph *graph, struct Factor factor, struct GrowingFactor *growth) {
  const struct Vertex *vertex = vertex_of(graph, factor.base);
  double logarithm = logarithm_of_base(graph, vertex);
  *growth =
      (struct GrowingFactor){.operation = logarithm != 0.0 ? EXPONENTIAL : vertex->operation, .power = factor.exponent};
  bool is_hyperbolic = growth->operation == COSH || growth->operation == SINH;
  if (!is_whole_from_1(factor.exponent) || (growth->operation != EXPONENTIAL && !is_hyperbolic)) return false;
  growth->coefficient = coefficient_of(graph, logarithm != 0.0 ? vertex->right : vertex->left, &growth->base);
  if (logarithm != 0.0) growth->coefficient *= logarithm;
  if (!is_hyperbolic) growth->coefficient *= factor.exponent;
  return is_hyperbolic || growth->coefficient > 0.0 || !is_never_negative(graph, growth->base);
}

/* Growth rates of the terms of a sum, which grow like exp(rate base) in both directions of base. */
struct Rates {
  Node base;
  double unit; /* the smallest rate, or the coefficient of the hyperbolic functions; 0 for no growth */
  double most;
  bool up, down, is_hyperbolic;
};

/*
 * Adds a growing factor of a term to the rates; *rate is the sum over the term's factors. False without a common decay.
 */
static bool take_factor(struct Rates *rates, const struct GrowingFactor *growth, double *rate) {
  bool is_hyperbolic = growth->operation != EXPONENTIAL;
  if (rates->unit != 0.0 && growth->base != rates->base) return false;
  if (is_hyperbolic && rates->is_hyperbolic && growth->coefficient != rates->unit) return false;
  rates->base = growth->base;
  if (is_hyperbolic || rates->unit == 0.0) rates->unit = fabs(growth->coefficient);
  else if (!rates->is_hyperbolic) rates->unit = fmin(rates->unit, fabs(growth->coefficient));
  rates->is_hyperbolic |= is_hyperbolic;
  rates->up |= is_hyperbolic || growth->coefficient > 0.0;
  rates->down |= is_hyperbolic || growth->coefficient < 0.0;
  *rate += fabs(growth->coefficient) * (is_hyperbolic ? growth->power : 1.0);
  rates->most = fmax(rates->most, *rate);
  return true;
}

static bool take_term(const struct Graph *graph, Node term, struct Rates *rates) {
  struct Factor factors[FACTOR_LIMIT];
  int count = factors_of(graph, term, factors);
  double rate = 0.0;
  for (int i = 0; i < count; i++) {
    struct GrowingFactor growth;
    if (grows(graph, factors[i], &growth) && !take_factor(rates, &growth, &rate)) return false;
  }
  return true;
}

/* Finds the growth rates of a node's terms. False if they have no common decay. */
static bool rates_of(const struct Graph *graph, Node node, struct Rates *rates) {
  Node terms[TERM_LIMIT];
  *rates = (struct Rates){.base = ZERO};
  int count = terms_of(graph, node, terms, TERM_LIMIT);
  for (int i = 0; i < count; i++)
    if (!take_term(graph, terms[i], rates)) return false;
  return true;
}

/* Finds the decay that bounds a sum or one factor. False if there is none. */
static bool decay_of(struct Graph *graph, Node node, struct DecayingFactor *decay) {
  struct Rates rates;
  if (!rates_of(graph, node, &rates) || rates.unit == 0.0) return false;
  decay->power = rates.most / rates.unit;
  bool both = rates.up && rates.down;
  Node operand = scale(graph, both || rates.down ? rates.unit : -rates.unit, rates.base);
  decay->node = function(graph, both ? SECH : LOGISTIC, operand, ZERO);
  return is_whole_from_1(decay->power);
}

static bool is_bounded(const struct Graph *graph, Node sum) {
  struct Rates rates;
  return rates_of(graph, sum, &rates) && rates.unit == 0.0;
}

/* Returns the sum of the terms, each multiplied by a node. */
static Node distribute(struct Graph *graph, Node sum, Node node) {
  Node terms[TERM_LIMIT], result = ZERO;
  int count = terms_of(graph, sum, terms, TERM_LIMIT);
  for (int i = 0; i < count; i++) result = add(graph, result, multiply(graph, terms[i], node));
  return result;
}

/* Multiplies out powers of sums in a term, if the sums grow. */
static Node expand_term(struct Graph *graph, Node term) {
  enum { HIGHEST_POWER = 4 };
  Node base, result;
  struct Factor factors[FACTOR_LIMIT];
  double coefficient = coefficient_of(graph, term, &base);
  int count = factors_of(graph, base, factors);
  result = graph_constant(graph, coefficient);
  for (int i = 0; i < count; i++) {
    bool is_whole = is_whole_from_1(factors[i].exponent) && factors[i].exponent <= HIGHEST_POWER;
    bool grows_as_sum =
        vertex_of(graph, factors[i].base)->operation == ADD && is_whole && !is_bounded(graph, factors[i].base);
    if (!grows_as_sum) result = distribute(graph, result, power_number(graph, factors[i].base, factors[i].exponent));
    for (int n = 0; grows_as_sum && n < (int)factors[i].exponent; n++) {
      Node terms[TERM_LIMIT], sum = ZERO;
      int terms_now = terms_of(graph, result, terms, TERM_LIMIT);
      for (int k = 0; k < terms_now; k++) sum = add(graph, sum, distribute(graph, factors[i].base, terms[k]));
      result = sum;
    }
  }
  return count < 0 ? term : result;
}

/* Multiplies out powers of sums in all terms of a sum. */
static Node expand(struct Graph *graph, Node sum) {
  Node terms[TERM_LIMIT], result = ZERO;
  int count = terms_of(graph, sum, terms, TERM_LIMIT);
  for (int i = 0; i < count; i++) result = add(graph, result, expand_term(graph, terms[i]));
  return result;
}

/*
 * Splits base = inner / (s1^p1 s2^p2 ...), where inner is bounded: for each factor that grows, a decay; for exp(u)
 * it is exp(-u). Returns the number of decays; 0 if nothing grows, or if a growing factor has no decay.
 */
static int split(struct Graph *graph, Node base, struct DecayingFactor decays[FACTOR_LIMIT], Node *inner) {
  Node bare;
  struct Factor factors[FACTOR_LIMIT];
  double coefficient = coefficient_of(graph, base, &bare);
  int count = factors_of(graph, bare, factors), found = 0;
  *inner = graph_constant(graph, coefficient);
  for (int i = 0; i < count; i++) {
    struct GrowingFactor growth;
    struct DecayingFactor decay;
    Node scaled = ONE;
    bool is_exponential = grows(graph, factors[i], &growth) && growth.operation == EXPONENTIAL;
    bool is_sum = vertex_of(graph, factors[i].base)->operation == ADD;
    if (is_sum) factors[i].base = expand(graph, factors[i].base);
    if (is_exponential && vertex_of(graph, factors[i].base)->operation == EXPONENTIAL)
      decay = (struct DecayingFactor){
          function(graph, EXPONENTIAL, scale(graph, -growth.coefficient, growth.base), ZERO), 1.0};
    else if ((is_sum || growth.operation == COSH) && factors[i].exponent > 0.0 &&
             decay_of(graph, factors[i].base, &decay)) {
      Node by = power_number(graph, decay.node, decay.power);
      scaled = is_sum ? distribute(graph, factors[i].base, by) : multiply(graph, factors[i].base, by);
      if (!is_bounded(graph, scaled)) return 0;
      scaled = power_number(graph, scaled, factors[i].exponent);
      decay.power *= factors[i].exponent;
    } else {
      *inner = multiply(graph, *inner, power_number(graph, factors[i].base, factors[i].exponent));
      continue;
    }
    *inner = multiply(graph, *inner, scaled);
    decays[found++] = decay;
  }
  return found;
}

bool bounded_power(struct Graph *graph, Node base, double n, Node *result) {
  struct DecayingFactor decays[FACTOR_LIMIT];
  Node inner;
  int count = split(graph, base, decays, &inner);
  if (count == 0) return false;
  *result = power_number(graph, inner, n);
  for (int i = 0; i < count; i++)
    *result = multiply(graph, *result, power_number(graph, decays[i].node, -n * decays[i].power));
  return true;
}

/* Returns -log(decay). */
static Node logarithm_of_growth(struct Graph *graph, Node decay) {
  const struct Vertex vertex = *vertex_of(graph, decay);
  if (vertex.operation == EXPONENTIAL) return negate(graph, vertex.left);
  if (vertex.operation == SECH) return function(graph, LOG_COSH, vertex.left, ZERO);
  return function(graph, SOFTPLUS, negate(graph, vertex.left), ZERO);
}

bool bounded_logarithm(struct Graph *graph, Node node, Node *result) {
  struct DecayingFactor decays[FACTOR_LIMIT];
  Node inner;
  int count = split(graph, node, decays, &inner);
  if (count == 0) return false;
  *result = function(graph, LOGARITHM, inner, ZERO);
  for (int i = 0; i < count; i++)
    *result = add(graph, *result, scale(graph, decays[i].power, logarithm_of_growth(graph, decays[i].node)));
  return true;
}

/* Replaces the growing exponentials of a factor by capped ones. Returns their number; 2 if they cannot be replaced. */
static int cap_factor(struct Graph *graph, struct Factor factor, Node *result) {
  struct GrowingFactor growth;
  Node inner;
  *result = power_number(graph, factor.base, factor.exponent);
  if (vertex_of(graph, factor.base)->operation == ADD && factor.exponent > 0.0) {
    if (!bounded_argument(graph, factor.base, &inner)) return 0;
    *result = power_number(graph, inner, factor.exponent);
    return 1;
  }
  if (!grows(graph, factor, &growth)) return 0;
  if (growth.operation != EXPONENTIAL) return 2;
  *result = function(graph, CAPPED_EXPONENTIAL, scale(graph, growth.coefficient, growth.base), ZERO);
  return 1;
}

/* Replaces the growing exponentials of a term by capped ones. Returns the same as cap_factor(). */
static int cap_term(struct Graph *graph, Node term, Node *result) {
  Node base;
  struct Factor factors[FACTOR_LIMIT];
  double coefficient = coefficient_of(graph, term, &base);
  int count = factors_of(graph, base, factors), found = 0;
  *result = graph_constant(graph, coefficient);
  for (int i = 0; i < count; i++) {
    Node factor;
    found += cap_factor(graph, factors[i], &factor);
    *result = multiply(graph, *result, factor);
  }
  return found;
}

/* Two exponentials that grow may cancel each other, so that the argument is not large: then nothing is rewritten. */
bool bounded_argument(struct Graph *graph, Node argument, Node *result) {
  Node terms[TERM_LIMIT];
  int count = terms_of(graph, argument, terms, TERM_LIMIT), found = 0;
  *result = ZERO;
  for (int i = 0; i < count; i++) {
    Node term;
    int grown = vertex_of(graph, terms[i])->operation == ADD ? 2 : cap_term(graph, terms[i], &term);
    found += grown;
    *result = add(graph, *result, grown == 1 ? term : terms[i]);
  }
  return found == 1;
}

/* The bounded product of powers of a growing and of a decaying factor. */
struct BoundedProduct {
  Node product;
  double left, right; /* the exponents in it */
};

/* Joins exp(u)^m with a decay along the same base. */
static bool join_exponential(struct Graph *graph, const struct GrowingFactor *growth, struct Factor left,
                             struct Factor right, struct BoundedProduct *joined) {
  Node base;
  const struct Vertex vertex = *vertex_of(graph, right.base);
  double coefficient = coefficient_of(graph, vertex.left, &base), rate = fabs(coefficient);
  bool is_opposite = vertex.operation == SECH || growth->coefficient * coefficient < 0.0;
  if (base == growth->base && is_opposite && vertex.operation == LOGISTIC &&
      2.0 * fabs(growth->coefficient) == rate) { /* exp(u) / (1 + exp(2 u)) = 1/(2 cosh(u)) */
    Node quotient = function(graph, SECH, scale(graph, fabs(growth->coefficient), base), ZERO);
    *joined = (struct BoundedProduct){scale(graph, 0.5, quotient), left.exponent, 1.0};
    return true;
  }
  double count = fmin(floor(fabs(growth->coefficient) / rate), floor(right.exponent));
  if (base != growth->base || !is_opposite || count < 1.0) return false;
  double upwards = growth->coefficient > 0.0 ? rate : -rate, rest = growth->coefficient - count * upwards;
  bool is_symmetric = vertex.operation == SECH;
  Node operand = scale(graph, is_symmetric ? 2.0 * upwards : upwards, base);
  Node bounded = scale(graph, is_symmetric ? 2.0 : 1.0, function(graph, LOGISTIC, operand, ZERO));
  joined->product = power_number(graph, bounded, count);
  if (rest != 0.0)
    joined->product =
        graph_node(graph, MULTIPLY, joined->product, function(graph, EXPONENTIAL, scale(graph, rest, base), ZERO));
  joined->left = left.exponent;
  joined->right = count;
  return true;
}

/* Joins sinh(u) or cosh(u) with 1/cosh(u): to tanh(u), or 1. */
static bool join_hyperbolic(struct Graph *graph, struct Factor left, struct Factor right,
                            struct BoundedProduct *joined) {
  const struct Vertex *growing = vertex_of(graph, left.base), *decaying = vertex_of(graph, right.base);
  if (decaying->operation != SECH || growing->left != decaying->left) return false;
  joined->left = joined->right = fmin(floor(left.exponent), floor(right.exponent));
  Node bounded = growing->operation == SINH ? function(graph, TANH, growing->left, ZERO) : ONE;
  joined->product = power_number(graph, bounded, joined->left);
  return true;
}

/* Joins exp(u) exp(-v), where u and v are multiples of one expression. */
static bool join_opposite(struct Graph *graph, const struct GrowingFactor *growth, struct Factor left,
                          struct Factor right, struct BoundedProduct *joined) {
  struct GrowingFactor other;
  if (!grows(graph, right, &other) || vertex_of(graph, right.base)->operation != EXPONENTIAL) return false;
  if (other.base != growth->base || other.coefficient * growth->coefficient > 0.0) return false;
  Node operand = scale(graph, growth->coefficient + other.coefficient, growth->base);
  *joined = (struct BoundedProduct){function(graph, EXPONENTIAL, operand, ZERO), left.exponent, right.exponent};
  return true;
}

/* Multiplies out a power of a sum, and each term by a decay along the same base, to the least power that bounds it. */
static bool join_expanded(struct Graph *graph, struct Factor left, struct Factor right, struct BoundedProduct *joined) {
  enum { HIGHEST_POWER = 4 };
  Node base, sum = expand_term(graph, power_number(graph, left.base, left.exponent));
  struct Rates rates;
  coefficient_of(graph, vertex_of(graph, right.base)->left, &base);
  if (!rates_of(graph, sum, &rates) || rates.base != base) return false;
  for (int power = 1; power <= HIGHEST_POWER && power <= right.exponent; power++) {
    *joined =
        (struct BoundedProduct){distribute(graph, sum, power_number(graph, right.base, power)), left.exponent, power};
    if (is_bounded(graph, joined->product)) return true;
  }
  return false;
}

static bool join_sum(struct Graph *graph, struct Factor left, struct Factor right, struct BoundedProduct *joined) {
  struct DecayingFactor decay;
  if (left.exponent < 1.0 || !decay_of(graph, left.base, &decay)) return false;
  if (decay.node != right.base || decay.power > right.exponent) return join_expanded(graph, left, right, joined);
  Node sum = distribute(graph, left.base, power_number(graph, decay.node, decay.power));
  *joined = (struct BoundedProduct){sum, 1.0, decay.power};
  return is_bounded(graph, sum);
}

static bool join(struct Graph *graph, struct Factor left, struct Factor right, struct BoundedProduct *joined) {
  struct GrowingFactor growth;
  enum Operation operation = vertex_of(graph, right.base)->operation;
  bool decays = (operation == LOGISTIC || operation == SECH) && right.exponent >= 1.0;
  if (decays && vertex_of(graph, left.base)->operation == ADD) return join_sum(graph, left, right, joined);
  if ((!decays && operation != EXPONENTIAL) || !grows(graph, left, &growth)) return false;
  if (!decays)
    return vertex_of(graph, left.base)->operation == EXPONENTIAL && join_opposite(graph, &growth, left, right, joined);
  if (growth.operation == EXPONENTIAL) return join_exponential(graph, &growth, left, right, joined);
  return join_hyperbolic(graph, left, right, joined);
}

/* Returns the product of the factors, with the exponent of one of them reduced. */
static Node remaining(struct Graph *graph, const struct Factor *factors, int count, int index, double less) {
  struct Factor rest[FACTOR_LIMIT];
  int rest_count = 0;
  for (int i = 0; i < count; i++) {
    struct Factor factor = factors[i];
    if (i == index) factor.exponent -= less;
    if (factor.exponent != 0.0) rest[rest_count++] = factor;
  }
  return product_of(graph, rest, rest_count);
}

bool bounded_product(struct Graph *graph, const struct Factor *left, int left_count, const struct Factor *right,
                     int right_count, Node *result) {
  for (int i = 0; i < left_count; i++) {
    for (int j = 0; j < right_count; j++) {
      struct BoundedProduct joined;
      bool forwards = join(graph, left[i], right[j], &joined);
      if (!forwards && !join(graph, right[j], left[i], &joined)) continue;
      Node first = remaining(graph, left, left_count, i, forwards ? joined.left : joined.right);
      Node second = remaining(graph, right, right_count, j, forwards ? joined.right : joined.left);
      *result = multiply(graph, multiply(graph, first, second), joined.product);
      return true;
    }
  }
  return false;
}

bool are_complements(const struct Graph *graph, Node left, Node right) {
  const struct Vertex *a = vertex_of(graph, left), *b = vertex_of(graph, right);
  if (a->operation != LOGISTIC || b->operation != LOGISTIC) return false;
  Node first, second;
  double sum = coefficient_of(graph, a->left, &first) + coefficient_of(graph, b->left, &second);
  return first == second && sum == 0.0;
}
