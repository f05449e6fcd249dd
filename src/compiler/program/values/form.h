/* How a node is computed: an operation of the graph, or a shorter one that stands for two of them. */
#pragma once

#include "algebra/cone.h"

enum FormKind { FORM_SUM, FORM_DIFFERENCE, FORM_PRODUCT, FORM_QUOTIENT, FORM_NEGATION, FORM_POWER, FORM_FUNCTION };

struct Form {
  enum FormKind kind;
  Node left, right;
  int arity;
};

/*
 * The nodes that are computed for some targets, and how often each is needed. What is fetched, as symbols, numbers and
 * prepared values are, has members, but not what it is made of.
 */
struct Needs {
  const struct Graph *graph;
  struct Cone *cone;
  size_t *uses; /* of each member; a target counts twice, as it is written by itself */
  size_t capacity;
  bool preparing; /* expressions of parameters are computed, not fetched */
};

struct Needs *needs_create(const struct Graph *graph);

/* Replaces what was collected before. */
void needs_collect(struct Needs *needs, const Node *targets, size_t count, bool preparing);

/* Whether the node is a symbol, a number or a prepared value. */
bool is_fetched(const struct Needs *needs, Node node);

/* The form of a member, with a + (-b) turned to a - b and a * (1 / b) to a / b where nothing else needs 1 / b. */
struct Form form_of(const struct Needs *needs, Node node);
