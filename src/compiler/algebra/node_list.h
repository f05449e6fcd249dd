/* Lists of nodes. */
#pragma once

#include "algebra/graph.h"

/* A growing list of nodes. */
struct NodeList {
  Node *nodes;
  size_t count;
};

/* Appends nodes at the end of the list. */
void append_node(struct NodeList *list, Node node);
void append_nodes(struct NodeList *list, const Node *nodes, size_t count);

/* Sorts nodes in ascending order. */
void sort_nodes(Node *nodes, size_t count);
