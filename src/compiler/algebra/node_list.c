#include "algebra/node_list.h"

#include <stdlib.h>

#include "base/memory.h"

void append_node(struct NodeList *list, Node node) {
  APPEND(list->nodes, list->count, node);
}

void append_nodes(struct NodeList *list, const Node *nodes, size_t count) {
  for (size_t i = 0; i < count; i++) append_node(list, nodes[i]);
}

static int compare(const void *first, const void *second) {
  Node a = *(const Node *)first, b = *(const Node *)second;
  return (a > b) - (a < b);
}

void sort_nodes(Node *nodes, size_t count) {
  qsort(nodes, count, sizeof *nodes, compare);
}
