#include "mechanics/time_derivative.h"

#include "memory.h"

Node *time_seeds(const struct Model *model, bool with_accelerations) {
  const struct Graph *graph = model->graph;
  Node *seeds = allocate(graph->symbol_count, sizeof *seeds);
  seeds[graph->vertices[model->time].left] = ONE;
  for (size_t i = 0; i < model->coordinates.count; i++) {
    seeds[graph->vertices[model->coordinates.items[i].node].left] = model->velocities.items[i].node;
    if (with_accelerations) seeds[graph->vertices[model->velocities.items[i].node].left] = model->accelerations[i];
  }
  return seeds;
}
