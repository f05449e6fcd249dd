/* Dependencies of values on symbols (FMI 2.0.4, section 2.2.8); for accelerations, by the equations of motion. */
#pragma once

#include "mechanics/equations.h"

/* None, with a constant factor, with a factor of parameters, or other; ascending. */
enum Dependency { INDEPENDENT, CONSTANT_FACTOR, TUNABLE_FACTOR, DEPENDENT };

/* Workspace for the dependencies of one node after another. Each search visits only the nodes below. */
struct Dependencies {
  const struct Model *model;
  const struct Graph *graph;
  const struct Equations *equations;
  enum Dependency *of; /* [symbols of the graph] */
  size_t *symbols;     /* those that are not INDEPENDENT, in no particular order */
  size_t count;
  struct SymbolList *symbols_of_block; /* of blocks that are solved at run time; filled in when needed */
};

/* Returns a workspace for a model and its equations, which must outlive it. */
struct Dependencies *dependencies_create(const struct Model *model, const struct Equations *equations);

/*
 * Finds the dependencies of node. An acceleration that is solved for at run time depends on all symbols in its block's
 * equations. With initial, includes those of start values that are expressions.
 */
void dependencies_find(struct Dependencies *dependencies, Node node, bool initial);
