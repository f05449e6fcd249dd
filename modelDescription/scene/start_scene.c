#include "start_scene.h"

#include <math.h>

#include "base/memory.h"
#include "configurations.h"

/* Returns the view along a horizontal direction and down. */
static struct View view_in_space(const struct Model *model) {
  const double azimuth = -1.1, elevation = 0.35; /* rad */
  struct View view = {.is_in_space = true};
  int up = 2;
  for (int axis = 0; axis < 3; axis++)
    if (model->mechanism.gravity.along[axis] != ZERO) up = axis;
  int first = (up + 1) % 3, second = (up + 2) % 3;
  view.right[first] = -sin(azimuth);
  view.right[second] = cos(azimuth);
  view.up[up] = cos(elevation);
  view.up[first] = -sin(elevation) * cos(azimuth);
  view.up[second] = -sin(elevation) * sin(azimuth);
  return view;
}

/*
 * Returns the view: planar systems with x to the right and y or z up; others oblique from above, with gravity
 * downwards. Drawings of lines may lie in the plane of x and z; surfaces and joints that are guessed need space for z.
 */
static struct View view_of(const struct SampledPositions *samples) {
  const struct LineDrawing *drawing = &samples->model->drawing;
  bool has_y = false, has_z = false;
  for (size_t i = 0; i < samples->object_count; i++) {
    has_y |= samples->objects[i].position[1] != ZERO;
    has_z |= samples->objects[i].position[2] != ZERO;
  }
  for (size_t i = 0; i < 2 * drawing->count; i++) {
    has_y |= drawing->lines[i / 2].ends[i % 2].position[1] != ZERO;
    has_z |= drawing->lines[i / 2].ends[i % 2].position[2] != ZERO;
  }
  if (has_z && (has_y || !has_described_lines(drawing))) return view_in_space(samples->model);
  return (struct View){.right = {1.0, 0.0, 0.0}, .up = {0.0, !has_z, has_z}};
}

double *values_of_lines(const struct Model *model, const double *symbols, const double *values) {
  const struct Graph *graph = model->drawing.graph;
  if (graph == NULL) return NULL;
  double *of_lines = allocate(graph->symbol_count, sizeof *of_lines);
  for (size_t i = 0; i < graph->symbol_count && i < model->graph->symbol_count; i++)
    of_lines[i] = graph->symbols[i].kind == COORDINATE ? values[graph->symbols[i].node] : symbols[i];
  double *found = graph_evaluate(graph, of_lines);
  release(of_lines);
  return found;
}

struct StartScene start_scene_of(const struct Model *model) {
  struct Configurations everything = configurations_of(model, NULL);
  struct StartScene scene = {.model = model, .samples = sample_positions(model, true, NULL)};
  scene.connections = find_connections(&scene.samples);
  scene.surfaces = find_surfaces(&scene.samples);
  release_positions(&scene.samples);
  double *start = start_values(model);
  scene.values = values_at(&everything, NULL);
  if (scene.values == NULL) scene.values = graph_evaluate(model->graph, start);
  scene.line_values = values_of_lines(model, start, scene.values);
  scene.view = view_of(&scene.samples);
  return scene;
}
