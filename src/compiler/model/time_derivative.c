#include "model/time_derivative.h"

#include "base/memory.h"

Node *time_seeds(const struct Model *model, bool with_accelerations) {
  const struct Graph *graph = model->graph;
  Node *seeds = allocate(graph->symbol_count, sizeof *seeds);
  seeds[graph->vertices[model->time].left] = ONE;
  for (size_t i = 0; i < model->inputs.count; i++)
    seeds[graph->vertices[model->inputs.items[i].node].left] = model->prescribed.input_rates[i];
  for (size_t i = 0; i < model->states.count; i++)
    seeds[graph->vertices[model->states.items[i].node].left] = model->states.items[i].rate;
  for (size_t i = 0; i < model->coordinates.count; i++) {
    Node *rate = &seeds[graph->vertices[model->velocities.items[i].node].left];
    seeds[graph->vertices[model->coordinates.items[i].node].left] = model->velocities.items[i].node;
    if (model->prescribed.motions[i].is_prescribed) *rate = model->prescribed.motions[i].acceleration;
    else if (with_accelerations) *rate = model->unknowns.accelerations[i];
  }
  return seeds;
}
