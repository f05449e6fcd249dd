/*
 * Finds common factors of products by Breuer's greedy method: the most frequent pair of factors becomes a new factor,
 * until no pair occurs twice (M. A. Breuer: Generation of optimal code for expressions via factorization,
 * Communications of the ACM 12, 1969). Each round lowers the number of factors, so it ends. A round sorts all p pairs,
 * in O(p log p) steps; DECIDING_LIMIT bounds p.
 */
#include "algebra/polynomials/shared_products.h"

#include <stdlib.h>

#include "algebra/cone.h"
#include "algebra/simplify.h"
#include "base/memory.h"

/*
 * Most factors in products that decide on pairs. The number of pairs grows with the square of a product's length, that
 * of rounds with the number of products.
 */
enum { DECIDING_LIMIT = 800 };

/* A product, whose factors are replaced by pairs. */
struct Product {
  Node node;
  struct Factor factors[FACTOR_LIMIT]; /* ascending by base */
  int count;
  bool decides; /* its pairs are counted; those of others are only replaced */
};

/* A product of two bases, with left <= right. */
struct FactorPair {
  Node left, right;
};

/*
 * State of the method. Bases below first_pair are nodes; the others are pairs, in the order in which they were found.
 */
struct ProductSharing {
  struct Graph *graph;
  Node *members; /* all nodes below the given ones, ascending */
  size_t member_count;
  Node first_pair;
  Node *value; /* [node or pair]: its replacement; ZERO while unknown */
  struct FactorPair *pairs;
  size_t pair_count;
  struct Product *products;
  size_t product_count, deciding_count; /* of products; of factors in those that decide */
};

static bool is_sum(const struct Graph *graph, Node node) {
  return graph->vertices[node].operation == ADD;
}

static bool is_product(const struct Graph *graph, Node node) {
  Node base;
  enum Operation operation = graph->vertices[node].operation;
  return (operation == MULTIPLY || operation == POWER) && coefficient_of(graph, node, &base) == 1.0;
}

/* Marks the terms of marked sums, and the factors of marked products. */
static void mark_terms(const struct Graph *graph, const struct Cone *cone, bool *is_term) {
  for (size_t i = cone->count; i-- > 0;) {
    Node node = cone->nodes[i], base;
    const struct Vertex *vertex = &graph->vertices[node];
    struct Factor factors[FACTOR_LIMIT];
    if (!is_term[node]) continue;
    if (is_sum(graph, node)) is_term[vertex->left] = is_term[vertex->right] = true;
    else if (is_product(graph, node))
      for (int k = factors_of(graph, node, factors); k-- > 0;) is_term[factors[k].base] = true;
    else if (coefficient_of(graph, node, &base) != 1.0) is_term[base] = true;
  }
}

static void append_products(struct ProductSharing *sharing, const bool *is_term, const bool *decides) {
  for (size_t i = 0; i < sharing->member_count; i++) {
    struct Product product = {.node = sharing->members[i]};
    if (!is_term[product.node] || !is_product(sharing->graph, product.node)) continue;
    product.count = factors_of(sharing->graph, product.node, product.factors);
    product.decides = decides[product.node];
    if (product.count < 0) continue;
    if (product.decides) sharing->deciding_count += (size_t)product.count;
    APPEND(sharing->products, sharing->product_count, product);
  }
}

/*
 * Returns how often a product contains a pair. Only factors with the exponents 1 and 2 form pairs: other powers have
 * their own recurrences and step bounds.
 */
static int times_of(const struct Factor *left, const struct Factor *right) {
  bool are_usable =
      (left->exponent == 1.0 || left->exponent == 2.0) && (right->exponent == 1.0 || right->exponent == 2.0);
  if (!are_usable) return 0;
  if (left->base == right->base) return left->exponent == 2.0;
  return left->exponent == 2.0 && right->exponent == 2.0 ? 2 : 1;
}

static int compare_pairs(const void *a, const void *b) {
  const struct FactorPair *one = a, *other = b;
  if (one->left != other->left) return one->left < other->left ? -1 : 1;
  return (one->right > other->right) - (one->right < other->right);
}

/* Returns all pairs of deciding products, sorted, each as often as it occurs. */
static struct FactorPair *pairs_of(const struct ProductSharing *sharing, size_t *count) {
  struct FactorPair *pairs = NULL;
  *count = 0;
  for (size_t k = 0; k < sharing->product_count; k++) {
    const struct Product *product = &sharing->products[k];
    for (int i = 0; i < product->count && product->decides; i++)
      for (int j = i; j < product->count; j++)
        for (int times = times_of(&product->factors[i], &product->factors[j]); times > 0; times--) {
          APPEND(pairs, *count, (struct FactorPair){product->factors[i].base, product->factors[j].base});
        }
  }
  graph_work(sharing->graph, *count);
  if (*count > 0) qsort(pairs, *count, sizeof *pairs, compare_pairs);
  return pairs;
}

static bool is_constant(const struct ProductSharing *sharing, Node base) {
  if (base < sharing->first_pair) return graph_is_constant_in_time(sharing->graph, base);
  const struct FactorPair *pair = &sharing->pairs[base - sharing->first_pair];
  return is_constant(sharing, pair->left) && is_constant(sharing, pair->right);
}

/* Finds the most frequent pair; among equals, one of two factors that vary in time. False if none occurs twice. */
static bool find_most_frequent(const struct ProductSharing *sharing, struct FactorPair *best) {
  size_t count, most = 1;
  bool best_moves = false;
  struct FactorPair *pairs = pairs_of(sharing, &count);
  for (size_t i = 0, end; i < count; i = end) {
    for (end = i + 1; end < count && compare_pairs(&pairs[i], &pairs[end]) == 0;) end++;
    bool moves = !is_constant(sharing, pairs[i].left) && !is_constant(sharing, pairs[i].right);
    if (end - i < most || end - i == 1 || (end - i == most && (best_moves || !moves))) continue;
    most = end - i;
    best_moves = moves;
    *best = pairs[i];
  }
  release(pairs);
  return most > 1;
}

static struct Factor *factor_with(struct Product *product, Node base) {
  for (int i = 0; i < product->count; i++)
    if (product->factors[i].base == base) return &product->factors[i];
  return NULL;
}

static void remove_spent(struct Product *product) {
  int kept = 0;
  for (int i = 0; i < product->count; i++)
    if (product->factors[i].exponent != 0.0) product->factors[kept++] = product->factors[i];
  product->count = kept;
}

static void replace_pair(struct Product *product, struct FactorPair pair, Node base) {
  struct Factor *left = factor_with(product, pair.left), *right = factor_with(product, pair.right);
  int times = left != NULL && right != NULL ? times_of(left, right) : 0;
  if (times == 0) return;
  left->exponent -= times;
  right->exponent -= times;
  remove_spent(product);
  if (product->count < FACTOR_LIMIT) product->factors[product->count++] = (struct Factor){base, times};
}

static void replace_pairs(struct ProductSharing *sharing) {
  struct FactorPair pair;
  while (graph_limit(sharing->graph) == NULL && find_most_frequent(sharing, &pair)) {
    Node base = sharing->first_pair + (Node)sharing->pair_count;
    APPEND(sharing->pairs, sharing->pair_count, pair);
    for (size_t i = 0; i < sharing->product_count; i++) replace_pair(&sharing->products[i], pair, base);
  }
}

static Node value_of(struct ProductSharing *sharing, Node base) {
  if (base < sharing->first_pair || sharing->value[base] != ZERO) return sharing->value[base];
  struct FactorPair pair = sharing->pairs[base - sharing->first_pair];
  Node left = value_of(sharing, pair.left), right = value_of(sharing, pair.right);
  sharing->value[base] =
      left == right ? power_number(sharing->graph, left, 2.0) : graph_node(sharing->graph, MULTIPLY, left, right);
  return sharing->value[base];
}

static Node product_value(struct ProductSharing *sharing, struct Product product) {
  for (int i = 0; i < product.count; i++)
    if (product.factors[i].base != product.node) product.factors[i].base = value_of(sharing, product.factors[i].base);
  return product_of(sharing->graph, product.factors, product.count);
}

static void find_values(struct ProductSharing *sharing, const bool *is_term) {
  struct Graph *graph = sharing->graph;
  sharing->value = allocate(sharing->first_pair + sharing->pair_count, sizeof *sharing->value);
  for (size_t i = 0, next = 0; i < sharing->member_count; i++) {
    Node node = sharing->members[i], base;
    struct Vertex vertex = graph->vertices[node];
    double coefficient = coefficient_of(graph, node, &base);
    sharing->value[node] = node;
    if (next < sharing->product_count && sharing->products[next].node == node)
      sharing->value[node] = product_value(sharing, sharing->products[next++]);
    else if (is_term[node] && is_sum(graph, node))
      sharing->value[node] = add(graph, sharing->value[vertex.left], sharing->value[vertex.right]);
    else if (is_term[node] && base != ONE && coefficient != 1.0)
      sharing->value[node] = scale(graph, coefficient, sharing->value[base]);
  }
}

static bool *terms_below(struct Graph *graph, size_t count, const Node *nodes) {
  bool *is_term = allocate(graph->count, sizeof *is_term);
  for (size_t i = 0; i < count; i++) is_term[nodes[i]] = true;
  cone_collect(graph->cone, graph, nodes, count);
  mark_terms(graph, graph->cone, is_term);
  return is_term;
}

void share_products(struct Graph *graph, size_t leading, size_t count, Node *nodes) {
  if (graph_limit(graph) != NULL) return;
  bool *decides = terms_below(graph, leading, nodes), *is_term = terms_below(graph, count, nodes);
  struct ProductSharing sharing = {
      .graph = graph, .first_pair = (Node)graph->count, .member_count = graph->cone->count};
  sharing.pairs = make_room(NULL, 0, sizeof *sharing.pairs);
  sharing.products = make_room(NULL, 0, sizeof *sharing.products);
  sharing.members = allocate(sharing.member_count, sizeof *sharing.members);
  for (size_t i = 0; i < sharing.member_count; i++) sharing.members[i] = graph->cone->nodes[i];
  append_products(&sharing, is_term, decides);
  if (sharing.deciding_count <= DECIDING_LIMIT) {
    replace_pairs(&sharing);
    find_values(&sharing, is_term);
    for (size_t i = 0; i < count; i++) nodes[i] = sharing.value[nodes[i]];
  }
  release(sharing.value);
  release(sharing.pairs);
  release(sharing.products);
  release(sharing.members);
  release(is_term);
  release(decides);
}
