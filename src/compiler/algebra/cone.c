#include "algebra/cone.h"

#include "algebra/node_list.h"
#include "base/memory.h"

struct Cone *cone_create(void) {
  return allocate(1, sizeof(struct Cone));
}

bool cone_has(const struct Cone *cone, Node node) {
  if (node >= cone->capacity) return false;
  size_t place = cone->place[node];
  return place < cone->count && cone->nodes[place] == node;
}

size_t cone_place(const struct Cone *cone, Node node) {
  return cone->place[node];
}

/* The places of nodes that are no members hold anything, so that nothing is cleared between two collections. */
static void add(struct Cone *cone, Node node) {
  if (cone_has(cone, node)) return;
  cone->place[node] = cone->count;
  cone->nodes[cone->count++] = node;
}

static void grow(struct Cone *cone, size_t capacity) {
  if (capacity <= cone->capacity) return;
  capacity += capacity / 2;
  cone->nodes = reallocate(cone->nodes, capacity, sizeof *cone->nodes);
  cone->place = reallocate(cone->place, capacity, sizeof *cone->place);
  for (size_t i = cone->capacity; i < capacity; i++) cone->place[i] = 0;
  cone->capacity = capacity;
}

/* A visit comes with the algebra that the sweep is for. */
enum { VISIT_WORK = 8 };

/* Puts the members in order: by going through all nodes between the first and the last, where most of them are members. */
static void sort(struct Cone *cone) {
  enum { SPARSENESS = 16 };
  Node first = (Node)-1, last = 0;
  for (size_t i = 0; i < cone->count; i++) {
    if (cone->nodes[i] < first) first = cone->nodes[i];
    if (cone->nodes[i] > last) last = cone->nodes[i];
  }
  if (cone->count == 0 || (last - first) / SPARSENESS > cone->count) {
    sort_nodes(cone->nodes, cone->count);
    for (size_t i = 0; i < cone->count; i++) cone->place[cone->nodes[i]] = i;
    return;
  }
  size_t count = 0;
  for (Node node = first; count < cone->count; node++) {
    /* Members before have moved to the places below count; those to come keep their places in the list until then. */
    if (!cone_has(cone, node)) continue;
    size_t place = cone->place[node];
    Node other = cone->nodes[count];
    cone->nodes[place] = other;
    cone->place[other] = place;
    cone->nodes[count] = node;
    cone->place[node] = count++;
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
  cone->work += VISIT_WORK * cone->count;
  if (ended) cone->count = 0;
  sort(cone);
  return !ended;
}

void cone_collect(struct Cone *cone, const struct Graph *graph, const Node *targets, size_t count) {
  cone_collect_part(cone, graph, targets, count, NULL, NULL);
}
