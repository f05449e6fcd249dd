#include "mechanics/energies.h"

#include <math.h>
#include <stdlib.h>

#include "algebra/differentiate.h"
#include "memory.h"
#include "algebra/rational.h"
#include "algebra/simplify.h"

Node stored_energy(const struct Model *model, Node potential) {
  struct Graph *graph = model->graph;
  size_t n = model->velocities.count;
  Node energy = potential, *slope = allocate(n, sizeof *slope);
  gradient_of(graph, energy, VELOCITY, n, slope);
  for (size_t i = 0; i < n; i++)
    energy = subtract(graph, energy, multiply(graph, slope[i], model->velocities.items[i].node));
  free(slope);
  return energy;
}

/* The degrees of an expression's terms in the velocities; without a highest one where it is no polynomial of them. */
struct Degrees {
  double lowest, highest;
};

static struct Degrees degrees_of_vertex(const struct Graph *graph, Node node, const struct Degrees *of) {
  const struct Vertex *vertex = &graph->vertices[node];
  struct Degrees left = of[vertex->left], right = of[vertex->right];
  if (!graph_depends_on(graph, node, VELOCITY)) return (struct Degrees){0, 0};
  switch (vertex->operation) {
  case SYMBOL: return (struct Degrees){1, 1};
  case ADD: return (struct Degrees){fmin(left.lowest, right.lowest), fmax(left.highest, right.highest)};
  case MULTIPLY: return (struct Degrees){left.lowest + right.lowest, left.highest + right.highest};
  case POWER: {
    double n = graph_is_constant(graph, vertex->right) ? graph_value(graph, vertex->right) : NAN;
    if (n > 0 && n == floor(n)) return (struct Degrees){n * left.lowest, n * left.highest};
    return (struct Degrees){0, INFINITY};
  }
  default: return (struct Degrees){0, INFINITY};
  }
}

static struct Degrees degrees_of(const struct Graph *graph, Node target) {
  bool *needed = allocate(graph->count, sizeof *needed);
  struct Degrees *of = allocate((size_t)target + 1, sizeof *of), result;
  graph_mark(graph, &target, 1, needed);
  for (Node node = 0; node <= target; node++)
    if (needed[node]) of[node] = degrees_of_vertex(graph, node, of);
  result = of[target];
  free(of);
  free(needed);
  return result;
}

Node energy_of_kinetic_term(const struct Model *model, Node term, bool *driven) {
  struct Degrees degrees = degrees_of(model->graph, term);
  /* Degrees below and above may cancel each other once multiplied out. */
  if (degrees.lowest != 2 || degrees.highest != 2)
    degrees = degrees_of(model->graph, simplify_fraction(model->graph, term));
  *driven = degrees.highest == 2 && degrees.lowest < 2;
  return degrees.highest == 2 ? term : negate(model->graph, stored_energy(model, term));
}
