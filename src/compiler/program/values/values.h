/* Values: expressions as instructions, where each shared operation is computed once. */
#pragma once

#include "program/values/form.h"
#include "program/values/prepared.h"
#include "program/values/routine.h"

struct Values {
  const struct Graph *graph;
  const struct Prepared *prepared;
  size_t coordinates; /* velocities are the states behind the coordinates */
  struct Needs *needs;
  struct Routine *routine; /* the one being filled */
  Place *local;            /* for each node: its local variable in the routine */
  bool *has_local;
  struct NodeList computed; /* the nodes that have one */
};

struct Values *values_create(const struct Graph *graph, const struct Prepared *prepared, size_t coordinates);

/* Begins a new routine. */
struct Routine *values_begin(struct Values *values);

/* Computes what the targets need and the routine does not hold yet. preparing: as in form.h. */
void values_compute(struct Values *values, const Node *targets, size_t count, bool preparing);

/* The place of a leaf, a prepared value or a computed node. */
Place values_place(const struct Values *values, Node node);

/* The routine has the value of the node in this place. */
void values_hold(struct Values *values, Node node, Place place);

/* The routine copies the value of a node to a place. */
void values_copy(struct Values *values, Place target, Node node);
