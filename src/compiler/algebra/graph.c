#include "algebra/graph.h"

#include <math.h>
#include <string.h>

#include "algebra/cone.h"
#include "algebra/functions.h"
#include "base/memory.h"

int operation_arity(enum Operation operation) {
  return functions[operation].of_one != NULL ? 1 : functions[operation].of_two != NULL ? 2 : 0;
}

const char *operation_name(enum Operation operation) {
  return functions[operation].name;
}

double operation_evaluate(enum Operation operation, double left, double right) {
  const struct Function *row = &functions[operation];
  return row->of_one != NULL ? row->of_one(left) : row->of_two != NULL ? row->of_two(left, right) : NAN;
}

struct Graph *graph_create(void) {
  struct Graph *graph = allocate(1, sizeof *graph);
  graph->bucket_count = 4096;
  graph->buckets = allocate(graph->bucket_count, sizeof *graph->buckets);
  graph->cone = cone_create();
  graph_constant(graph, 0.0);
  graph_constant(graph, 1.0);
  return graph;
}

/* Returns a copy of a list, with the capacity that make_room() expects. */
static void *copy_of_list(const void *items, size_t count, size_t size) {
  size_t capacity = 1;
  while (capacity < count) capacity *= 2;
  return memcpy(allocate(capacity, size), items, count * size);
}

struct Graph *graph_copy(const struct Graph *graph) {
  struct Graph *copy = allocate(1, sizeof *copy);
  *copy = *graph;
  copy->vertices = copy_of_list(graph->vertices, graph->count, sizeof *graph->vertices);
  copy->buckets = copy_of_list(graph->buckets, graph->bucket_count, sizeof *graph->buckets);
  copy->symbols = copy_of_list(graph->symbols, graph->symbol_count, sizeof *graph->symbols);
  copy->cone = cone_create();
  copy->cone->work = graph->cone->work;
  copy->is_large = NULL;
  copy->large_count = 0;
  return copy;
}

/* Constants are compared by their bits, so that NaN equals itself. */
static uint64_t bits_of(double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits;
}

static uint64_t hash(const struct Vertex *vertex) {
  uint64_t key =
      bits_of(vertex->value) ^ ((uint64_t)vertex->left << 32) ^ vertex->right ^ ((uint64_t)vertex->operation << 56);
  key ^= key >> 31;
  key *= 0x9e3779b97f4a7c15u;
  key ^= key >> 29;
  key *= 0xbf58476d1ce4e5b9u;
  return key ^ (key >> 32);
}

static bool same(const struct Vertex *a, const struct Vertex *b) {
  return a->operation == b->operation && a->left == b->left && a->right == b->right &&
         bits_of(a->value) == bits_of(b->value);
}

static void insert(struct Graph *graph, Node node) {
  size_t bucket = hash(&graph->vertices[node]) & (graph->bucket_count - 1);
  while (graph->buckets[bucket] != 0) bucket = (bucket + 1) & (graph->bucket_count - 1);
  graph->buckets[bucket] = node + 1;
}

static void grow(struct Graph *graph) {
  graph->vertices = make_room(graph->vertices, graph->count, sizeof *graph->vertices);
  if (2 * graph->count < graph->bucket_count) return;
  graph->bucket_count *= 2;
  graph->buckets = allocate(graph->bucket_count, sizeof *graph->buckets);
  for (Node node = 0; node < graph->count; node++) insert(graph, node);
}

void graph_work(const struct Graph *graph, size_t steps) {
  graph->cone->work += steps;
}

size_t graph_work_left(const struct Graph *graph) {
  return graph->cone->work < WORK_LIMIT ? WORK_LIMIT - graph->cone->work : 0;
}

_Static_assert(NODE_LIMIT == 4000000 && WORK_LIMIT == 200000000, "the texts of graph_limit() name the limits");

const char *graph_limit(const struct Graph *graph) {
  if (graph->overflow) return "more than 4000000 operations";
  return graph->cone->work > WORK_LIMIT ? "more than 200000000 steps to read and derive it" : NULL;
}

static Node intern(struct Graph *graph, struct Vertex vertex) {
  graph_work(graph, 2); /* the cost of the algebra around it */
  size_t bucket = hash(&vertex) & (graph->bucket_count - 1);
  for (; graph->buckets[bucket] != 0; bucket = (bucket + 1) & (graph->bucket_count - 1)) {
    Node node = graph->buckets[bucket] - 1;
    if (same(&graph->vertices[node], &vertex)) return node;
  }
  graph->overflow = graph->overflow || graph->count >= NODE_LIMIT;
  if (graph_limit(graph) != NULL) return ZERO;
  grow(graph);
  Node node = (Node)graph->count++;
  graph->vertices[node] = vertex;
  insert(graph, node);
  return node;
}

Node graph_constant(struct Graph *graph, double value) {
  graph->not_finite |= !isfinite(value);
  if (value == 0.0) value = 0.0; /* -0.0 becomes 0.0: there is one zero */
  return intern(graph, (struct Vertex){.operation = CONSTANT, .value = value});
}

Node graph_symbol(struct Graph *graph, enum SymbolKind kind, int index, const char *name) {
  size_t number = graph->symbol_count++;
  graph->symbols = make_room(graph->symbols, number, sizeof *graph->symbols);
  Node node = intern(graph, (struct Vertex){.operation = SYMBOL, .left = (Node)number, .kinds = 1u << kind});
  graph->symbols[number] = (struct Symbol){.kind = kind, .index = index, .name = copy_text(name), .node = node};
  return node;
}

const struct Symbol *graph_symbol_of(const struct Graph *graph, Node node) {
  return &graph->symbols[graph->vertices[node].left];
}

Node graph_node(struct Graph *graph, enum Operation operation, Node left, Node right) {
  uint32_t kinds = graph->vertices[left].kinds;
  if (operation_arity(operation) == 2) kinds |= graph->vertices[right].kinds;
  return intern(graph, (struct Vertex){.operation = operation, .left = left, .right = right, .kinds = kinds});
}

bool graph_is_constant(const struct Graph *graph, Node node) {
  return graph->vertices[node].operation == CONSTANT;
}

double graph_value(const struct Graph *graph, Node node) {
  return graph->vertices[node].value;
}

bool graph_depends_on(const struct Graph *graph, Node node, enum SymbolKind kind) {
  return (graph->vertices[node].kinds >> kind & 1u) != 0;
}

bool graph_is_constant_in_time(const struct Graph *graph, Node node) {
  return (graph->vertices[node].kinds & ~(1u << PARAMETER | 1u << MODE)) == 0;
}

void graph_mark(const struct Graph *graph, const Node *targets, size_t count, bool *flags) {
  memset(flags, 0, graph->count * sizeof *flags);
  Node last = 0;
  for (size_t i = 0; i < count; i++) {
    flags[targets[i]] = true;
    if (targets[i] > last) last = targets[i];
  }
  for (Node node = last + 1; node-- > 0;) {
    if (!flags[node]) continue;
    const struct Vertex *vertex = &graph->vertices[node];
    int arity = operation_arity(vertex->operation);
    if (arity > 0) flags[vertex->left] = true;
    if (arity > 1) flags[vertex->right] = true;
  }
}

static void evaluate(const struct Graph *graph, Node node, const double *symbol_values, double *values) {
  const struct Vertex *vertex = &graph->vertices[node];
  if (vertex->operation == CONSTANT) values[node] = vertex->value;
  else if (vertex->operation == SYMBOL) values[node] = symbol_values[vertex->left];
  else values[node] = operation_evaluate(vertex->operation, values[vertex->left], values[vertex->right]);
}

double *graph_evaluate(const struct Graph *graph, const double *symbol_values) {
  return graph_evaluate_first(graph, symbol_values, graph->count);
}

double *graph_evaluate_first(const struct Graph *graph, const double *symbol_values, size_t count) {
  double *values = allocate(count, sizeof *values);
  for (Node node = 0; node < count; node++) evaluate(graph, node, symbol_values, values);
  return values;
}

void graph_evaluate_part(const struct Graph *graph, const Node *nodes, size_t count, const double *symbol_values,
                         double *values) {
  for (size_t i = 0; i < count; i++) evaluate(graph, nodes[i], symbol_values, values);
}
