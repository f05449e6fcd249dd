#include "algebra/cone.h"

#include "algebra/node_list.h"
#include "base/memory.h"

struct Cone *cone_create(void) {
  return allocate(1, sizeof(struct Cone));
}

void cone_release(struct Cone *cone) {
  release(cone->nodes);
  release(cone->index);
  release(cone);
}

bool cone_has(const struct Cone *cone, Node node) {
  if (node >= cone->capacity) return false;
  size_t index = cone->index[node];
  return index < cone->count && cone->nodes[index] == node;
}

size_t cone_slot(const struct Cone *cone, Node node) {
  return cone->index[node];
}

/*
 * Adds a node. The set is a sparse set, which needs no clearing: index[] of other nodes may hold any number (P. Briggs,
 * L. Torczon: An efficient representation for sparse sets, ACM Letters on Programming Languages and Systems 2, 1993).
 */
static void add(struct Cone *cone, Node node) {
  if (cone_has(cone, node)) return;
  cone->index[node] = (uint32_t)cone->count;
  cone->nodes[cone->count++] = node;
}

static void grow(struct Cone *cone, size_t capacity) {
  if (capacity <= cone->capacity) return;
  capacity += capacity / 2;
  cone->nodes = reallocate(cone->nodes, capacity, sizeof *cone->nodes);
  cone->index = reallocate(cone->index, capacity, sizeof *cone->index);
  for (size_t i = cone->capacity; i < capacity; i++) cone->index[i] = 0;
  cone->capacity = capacity;
}

/* Steps of graph_work() for a visit, with the algebra that follows it; a collection that ended early has none. */
enum { VISIT_WORK = 8 };

/* Sorts the members, by a loop over all nodes between the first and the last if one in SPARSENESS is a member. */
static void sort(struct Cone *cone) {
  enum { SPARSENESS = 16 };
  Node first = (Node)-1, last = 0;
  for (size_t i = 0; i < cone->count; i++) {
    if (cone->nodes[i] < first) first = cone->nodes[i];
    if (cone->nodes[i] > last) last = cone->nodes[i];
  }
  if (cone->count == 0 || (last - first) / SPARSENESS > cone->count) {
    sort_nodes(cone->nodes, cone->count);
    for (uint32_t i = 0; i < cone->count; i++) cone->index[cone->nodes[i]] = i;
    return;
  }
  uint32_t count = 0;
  for (Node node = first; count < cone->count; node++) {
    /* Members below node are sorted, in nodes[0] to nodes[count - 1]; the others exchange places with them. */
    if (!cone_has(cone, node)) continue;
    uint32_t index = cone->index[node];
    Node other = cone->nodes[count];
    cone->nodes[index] = other;
    cone->index[other] = index;
    cone->nodes[count] = node;
    cone->index[node] = count++;
  }
}

bool cone_collect_part(struct Cone *cone, const struct Graph *graph, const Node *targets, size_t count,
                       enum Visit (*visit)(void *context, const struct Graph *graph, Node node), void *context) {
  grow(cone, graph->count);
  cone->count = 0;
  for (size_t i = 0; i < count; i++) add(cone, targets[i]);
  bool ended = false;
  for (size_t i = 0; i < cone->count && !ended; i++) {
    const struct Vertex *vertex = &graph->vertices[cone->nodes[i]];
    enum Visit answer = visit != NULL ? visit(context, graph, cone->nodes[i]) : VISIT_OPERANDS;
    ended = answer == VISIT_NO_MORE;
    int arity = answer == VISIT_OPERANDS ? operation_arity(vertex->operation) : 0;
    if (arity > 0) add(cone, vertex->left);
    if (arity == 2) add(cone, vertex->right);
  }
  cone->work += (ended ? 1 : VISIT_WORK) * cone->count;
  if (ended) cone->count = 0;
  sort(cone);
  return !ended;
}

void cone_collect(struct Cone *cone, const struct Graph *graph, const Node *targets, size_t count) {
  cone_collect_part(cone, graph, targets, count, NULL, NULL);
}
