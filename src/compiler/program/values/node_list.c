#include "program/values/node_list.h"

#include "base/memory.h"

void append_node(struct NodeList *list, Node node) {
  list->nodes = make_room(list->nodes, list->count, &list->capacity, sizeof *list->nodes);
  list->nodes[list->count++] = node;
}

void append_nodes(struct NodeList *list, const Node *nodes, size_t count) {
  for (size_t i = 0; i < count; i++) append_node(list, nodes[i]);
}
