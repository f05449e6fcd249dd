/* On which symbols a value depends (FMI 2.0.4, section 2.2.8), accelerations by way of the equations of motion. */
#pragma once

#include "mechanics/equations.h"

/* Not at all, with a constant factor, with a factor of parameters, or otherwise. */
enum Dependency { INDEPENDENT, CONSTANT_FACTOR, TUNABLE_FACTOR, DEPENDENT };

/* A workspace that finds the dependencies of one node after the other, each at the cost of what is below it. */
struct Dependencies {
  const struct Model *model;
  const struct Graph *graph;
  const struct Equations *equations;
  enum Dependency *of; /* each symbol of the graph */
  size_t *symbols;     /* those that are not INDEPENDENT, in no particular order */
  size_t count;
  struct SymbolList *symbols_of_block; /* of blocks of M that are solved at run time, where these have been asked for */
};

struct Dependencies *dependencies_create(const struct Model *model, const struct Equations *equations);

/*
 * Finds the dependencies of node. An acceleration that is solved for at run time depends on all that its block of
 * equations depends on. initial: also those of the start values that follow from parameters.
 */
void dependencies_find(struct Dependencies *dependencies, Node node, bool initial);
