/* Code generation for expressions: appends instructions to a function, each shared node once. */
#pragma once

#include "program/codegen/fused_operations.h"
#include "program/codegen/parameter_constants.h"
#include "program/codegen/ir.h"

/* State while a function is built. */
struct CodeGenerator {
  const struct Graph *graph;
  const struct ParameterConstants *parameter_constants;
  size_t coordinates; /* number of coordinates, after which the velocities follow in the state */
  struct NeededNodes *needs;
  struct IrFunction *ir; /* the function under construction */
  Slot *local;           /* for each node with has_local: the slot of its value in the function */
  bool *has_local;
  struct NodeList computed; /* the nodes with has_local */
};

struct CodeGenerator *generator_create(const struct Graph *graph, const struct ParameterConstants *parameter_constants,
                                       size_t coordinates);

/* Begins a new function. */
struct IrFunction *generator_begin(struct CodeGenerator *generator);

/*
 * Appends instructions for the targets and for all nodes they need that are not computed yet. preparing: see
 * fused_operations.h.
 */
void generator_compute(struct CodeGenerator *generator, const Node *targets, size_t count, bool preparing);

/* Returns the slot of a symbol, a number, a parameter constant or a computed node. */
Slot generator_slot(const struct CodeGenerator *generator, Node node);

/* Declares that the function has the value of the node in this slot. */
void generator_define(struct CodeGenerator *generator, Node node, Slot slot);

/* Appends a copy of the node's value to a slot. */
void generator_copy(struct CodeGenerator *generator, Slot target, Node node);
