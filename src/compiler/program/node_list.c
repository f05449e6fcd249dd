#include "program/node_list.h"

#include "memory.h"

void append_node(struct NodeList *list, Node node) {
  if (list->count == list->capacity) {
    list->capacity = 2 * list->capacity + 16;
    list->nodes = reallocate(list->nodes, list->capacity, sizeof *list->nodes);
  }
  list->nodes[list->count++] = node;
}

void append_nodes(struct NodeList *list, const Node *nodes, size_t count) {
  for (size_t i = 0; i < count; i++) append_node(list, nodes[i]);
}
