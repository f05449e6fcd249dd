/* Code generation for expressions: appends instructions to a routine, each shared node once. */
#pragma once

#include "program/values/form.h"
#include "program/values/parameter_constants.h"
#include "program/values/routine.h"

/* State while a routine is built. */
struct Values {
  const struct Graph *graph;
  const struct ParameterConstants *parameter_constants;
  size_t coordinates; /* number of coordinates, after which the velocities follow in the state */
  struct Needs *needs;
  struct Routine *routine; /* the routine under construction */
  Slot *local;             /* for each node with has_local: the slot of its value in the routine */
  bool *has_local;
  struct NodeList computed; /* the nodes with has_local */
};

struct Values *values_create(const struct Graph *graph, const struct ParameterConstants *parameter_constants,
                             size_t coordinates);

/* Begins a new routine. */
struct Routine *values_begin(struct Values *values);

/* Appends instructions for the targets and all nodes they need that are not computed yet. preparing: see form.h. */
void values_compute(struct Values *values, const Node *targets, size_t count, bool preparing);

/* Returns the slot of a symbol, a number, a parameter constant or a computed node. */
Slot values_slot(const struct Values *values, Node node);

/* Declares that the routine has the value of the node in this slot. */
void values_hold(struct Values *values, Node node, Slot slot);

/* Appends a copy of the node's value to a slot. */
void values_copy(struct Values *values, Slot target, Node node);
