/*
 * Finds by finite changes which point a coordinate translates, and which line it rotates. If a coordinate changes by h
 * and by 2 h, the point moves by h u and 2 h u with |u| = 1; the line rotates by h and 2 h about one axis. A line has
 * the length of a parameter if both agree to nine digits, for several values of all parameters and coordinates.
 */
#include "measures.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

/* Coordinates up to which each has its name in the drawing; samples of lengths. */
enum { MOST_MARKS = 8, TRIALS = 3 };

/*
 * The change h of a coordinate, in m or rad. The relative error up to which values are equal. The distance from the
 * centre of a planar body, in m, at which its angle is drawn.
 */
static const double CHANGE = 0.2, CLOSE = 1e-9, TIP = 0.1;

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void subtract(const double a[3], const double b[3], double difference[3]) {
  for (int i = 0; i < 3; i++) difference[i] = a[i] - b[i];
}

/*
 * Returns the positions of all objects. Points on the axis x of each follow, which rotate with planar bodies, and then
 * both ends of all lines.
 */
static double *points_at(const struct StartScene *scene, const double *symbols) {
  const struct Model *model = scene->model;
  size_t objects = scene->samples.object_count;
  double *values = graph_evaluate(model->graph, symbols), *line_values = values_of_lines(model, symbols, values);
  double *points = allocate(6 * (objects + model->drawing.count), sizeof *points);
  for (size_t i = 0; i < 3 * objects; i++) {
    const struct SceneObject *object = &scene->samples.objects[i / 3];
    double angle = object->is_planar ? values[object->angle] : 0.0;
    points[i] = values[object->position[i % 3]];
    points[3 * objects + i] = points[i] + TIP * (i % 3 == 0 ? cos(angle) : i % 3 == 1 ? sin(angle) : 0.0);
  }
  for (size_t i = 0; i < 6 * model->drawing.count; i++)
    points[6 * objects + i] = line_values[model->drawing.lines[i / 6].ends[i / 3 % 2].position[i % 3]];
  release(values);
  release(line_values);
  return points;
}

/* Returns the values of the symbols on the constraints. */
static double *symbols_of(const struct StartScene *scene) {
  const struct Model *model = scene->model;
  double *symbols = start_values(model);
  for (size_t i = 0; i < model->coordinates.count; i++) {
    Node node = model->coordinates.items[i].node;
    symbols[model->graph->vertices[node].left] = scene->values[node];
  }
  return symbols;
}

/* Returns the positions after a change of a coordinate. */
static double *points_after(const struct StartScene *scene, size_t coordinate, double change) {
  const struct Graph *graph = scene->model->graph;
  double *symbols = symbols_of(scene);
  symbols[graph->vertices[scene->model->coordinates.items[coordinate].node].left] += change;
  double *points = points_at(scene, symbols);
  release(symbols);
  return points;
}

/* True if the point moves by the change, along one direction; sets the ends of the mark. */
static bool is_translated(double *const points[3], size_t point, struct CoordinateMark *mark) {
  double first[3], second[3], bend = 0.0;
  subtract(points[1] + 3 * point, points[0] + 3 * point, first);
  subtract(points[2] + 3 * point, points[0] + 3 * point, second);
  for (int i = 0; i < 3; i++) {
    bend = fmax(bend, fabs(second[i] - 2.0 * first[i]));
    mark->to[i] = points[0][3 * point + (size_t)i];
    mark->along[i] = first[i] / CHANGE;
    mark->from[i] = mark->to[i] - mark->along[i] * mark->start;
  }
  return bend < CLOSE && fabs(sqrt(dot(first, first)) - CHANGE) < CLOSE;
}

/*
 * True if the line between two points rotates by the change about a fixed axis; sets the mark. The centre is on the axis,
 * nearest to the second point.
 */
static bool is_rotated(double *const points[3], size_t from, size_t to, struct CoordinateMark *mark) {
  double lines[3][3], step[2][3], axis[3], error = 0.0;
  for (int k = 0; k < 3; k++) subtract(points[k] + 3 * to, points[k] + 3 * from, lines[k]);
  for (int k = 0; k < 2; k++) subtract(lines[k + 1], lines[k], step[k]);
  for (int i = 0; i < 3; i++)
    axis[i] = step[0][(i + 1) % 3] * step[1][(i + 2) % 3] - step[0][(i + 2) % 3] * step[1][(i + 1) % 3];
  double length = sqrt(dot(axis, axis)), square = dot(lines[0], lines[0]);
  mark->is_rotation = true;
  if (!(length > CLOSE * square)) return false;
  for (int i = 0; i < 3; i++) mark->along[i] = axis[i] / length;
  double along = dot(mark->along, lines[0]), radius = square - along * along;
  for (int i = 0; i < 3; i++) {
    mark->from[i] = points[0][3 * from + (size_t)i] + along * mark->along[i];
    mark->to[i] = points[0][3 * to + (size_t)i];
  }
  for (int k = 1; k < 3; k++) {
    error = fmax(error, fabs(dot(lines[k], lines[k]) - square) + fabs(dot(mark->along, lines[k]) - along));
    error = fmax(error, fabs(dot(lines[0], lines[k]) - along * along - radius * cos(k * CHANGE)));
  }
  return error < CLOSE * square;
}

/* Sets the mark of a coordinate: that of the first point or line that it moves. Returns false if there is none. */
static bool find_mark(const struct StartScene *scene, double *const points[3], struct CoordinateMark *mark) {
  size_t objects = scene->samples.object_count;
  for (size_t i = 1; i < objects; i++)
    if (is_translated(points, i, mark)) return true;
  for (size_t i = 2 * objects; i < 2 * (objects + scene->model->drawing.count); i++)
    if (is_translated(points, i, mark)) return true;
  for (size_t i = 0; i < scene->model->drawing.count; i++)
    if (has_two_ends(&scene->model->drawing.lines[i]) &&
        is_rotated(points, 2 * (objects + i), 2 * (objects + i) + 1, mark))
      return true;
  for (size_t i = 1; i < objects; i++)
    if (is_rotated(points, scene->samples.objects[i].frame, i, mark) || is_rotated(points, i, objects + i, mark))
      return true;
  return false;
}

static void find_marks(const struct StartScene *scene, struct Measures *measures) {
  const struct VariableList *coordinates = &scene->model->coordinates;
  if (coordinates->count == 0 || coordinates->count > MOST_MARKS) return;
  double *points[3] = {points_after(scene, 0, 0.0)};
  for (size_t i = 0; i < coordinates->count; i++) {
    for (int k = 1; k < 3; k++) points[k] = points_after(scene, i, k * CHANGE);
    struct CoordinateMark mark = {.name = coordinates->items[i].name,
                                  .start = scene->values[coordinates->items[i].node]};
    if (find_mark(scene, points, &mark)) APPEND(measures->marks, measures->mark_count, mark);
    for (int k = 1; k < 3; k++) release(points[k]);
  }
  release(points[0]);
}

/* Removes the names of parameters that are not the lengths for these values of the symbols. */
static void compare_lengths(const struct StartScene *scene, const double *symbols, bool *is_length) {
  const struct Model *model = scene->model;
  double *points = points_at(scene, symbols), line[3];
  for (size_t i = 0; i < model->drawing.count; i++) {
    const double *ends = points + 6 * (scene->samples.object_count + i);
    subtract(ends + 3, ends, line);
    double length = sqrt(dot(line, line));
    for (size_t p = 0; p < model->parameters.count; p++) {
      double value = symbols[model->graph->vertices[model->parameters.items[p].node].left];
      is_length[i * model->parameters.count + p] &= length > 0.0 && fabs(length - value) < CLOSE * length;
    }
  }
  release(points);
}

static void find_lengths(const struct StartScene *scene, struct Measures *measures) {
  const struct Model *model = scene->model;
  size_t lines = model->drawing.count, parameters = model->parameters.count;
  bool *is_length = allocate(lines * parameters + 1, sizeof *is_length);
  memset(is_length, true, lines * parameters);
  measures->lengths = allocate(lines + 1, sizeof *measures->lengths);
  for (int trial = 1; trial <= TRIALS; trial++) {
    double *symbols = symbols_of(scene);
    for (size_t i = 0; i < model->graph->symbol_count; i++)
      symbols[i] += 0.1 * symbols[i] * sin(2.7 * (double)(i + 1) * trial);
    compare_lengths(scene, symbols, is_length);
    release(symbols);
  }
  for (size_t i = 0; i < lines; i++)
    for (size_t p = 0; p < parameters && has_two_ends(&model->drawing.lines[i]); p++)
      if (is_length[i * parameters + p]) measures->lengths[i] = model->parameters.items[p].name;
  release(is_length);
}

struct Measures find_measures(const struct StartScene *scene) {
  struct Measures measures = {.mark_count = 0};
  find_marks(scene, &measures);
  if (scene->line_values != NULL) find_lengths(scene, &measures);
  return measures;
}
