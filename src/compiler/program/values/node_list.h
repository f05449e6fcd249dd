/* A growing list of nodes. Free nodes with free(). */
#ifndef NODE_LIST_H
#define NODE_LIST_H

#include "algebra/graph.h"

struct NodeList {
  Node *nodes;
  size_t count, capacity;
};

void append_node(struct NodeList *list, Node node);
void append_nodes(struct NodeList *list, const Node *nodes, size_t count);

#endif
