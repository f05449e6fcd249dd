#include "line_drawing.h"

#include <math.h>

#include "base/memory.h"

/* A line in the picture: points are given by the share of its length, and by the distance to its right in m. */
struct PictureLine {
  struct PicturePoint from, to;
  double right, up; /* unit vector to its right */
  double length;    /* in m */
};

static struct PictureLine way_between(struct PicturePoint from, struct PicturePoint to) {
  double right = to.right - from.right, up = to.up - from.up, length = hypot(right, up);
  if (!(length > 0.0)) return (struct PictureLine){from, to, 1.0, 0.0, 0.0};
  return (struct PictureLine){from, to, up / length, -right / length, length};
}

static struct PicturePoint spot_at(const struct PictureLine *way, double share, double aside) {
  return (struct PicturePoint){way->from.right + share * (way->to.right - way->from.right) + aside * way->right,
                               way->from.up + share * (way->to.up - way->from.up) + aside * way->up};
}

static void append_between(struct Drawing *drawing, enum Look look, const struct PictureLine *way, const double from[2],
                           const double to[2]) {
  append_line(drawing, look, spot_at(way, from[0], from[1]), spot_at(way, to[0], to[1]));
}

/* Appends a rod of a given radius. */
static void append_thick(struct Drawing *drawing, const struct PictureLine *way, double radius) {
  struct PicturePoint corners[5] = {spot_at(way, 0.0, radius), spot_at(way, 1.0, radius), spot_at(way, 1.0, -radius),
                                    spot_at(way, 0.0, -radius), spot_at(way, 0.0, radius)};
  append_shape(drawing, SOLID, true, corners, 4);
  append_shape(drawing, EDGE, false, corners, 5);
}

static void append_coil(struct Drawing *drawing, const struct PictureLine *way, double radius) {
  enum { TURNS = 12 };
  struct PicturePoint spots[TURNS + 4];
  spots[0] = way->from;
  spots[1] = spot_at(way, 0.12, 0.0);
  for (int i = 0; i < TURNS; i++)
    spots[2 + i] = spot_at(way, 0.12 + 0.76 * (i + 0.5) / TURNS, i % 2 == 0 ? radius : -radius);
  spots[TURNS + 2] = spot_at(way, 0.88, 0.0);
  spots[TURNS + 3] = way->to;
  append_shape(drawing, ROPE, false, spots, TURNS + 4);
}

static void append_damper(struct Drawing *drawing, const struct PictureLine *way, double radius) {
  struct PicturePoint housing[4] = {spot_at(way, 0.65, radius), spot_at(way, 0.2, radius), spot_at(way, 0.2, -radius),
                                    spot_at(way, 0.65, -radius)};
  append_line(drawing, ROPE, way->from, spot_at(way, 0.2, 0.0));
  append_shape(drawing, ROPE, false, housing, 4);
  append_between(drawing, LINK, way, (double[]){0.5, -0.8 * radius}, (double[]){0.5, 0.8 * radius});
  append_line(drawing, ROPE, spot_at(way, 0.5, 0.0), way->to);
}

/* Appends two half circles and the straight parts between them. */
static void append_belt(struct Drawing *drawing, const struct PictureLine *way, double radius) {
  enum { HALF = 12, POINTS = 2 * (HALF + 1) };
  struct PicturePoint spots[POINTS + 1];
  for (int i = 0; i < POINTS; i++) {
    bool is_second = i > HALF;
    double angle = acos(-1.0) * (is_second ? i - HALF - 1 : i) / HALF, outwards = radius * sin(angle);
    struct PicturePoint spot = spot_at(way, is_second, is_second ? -radius * cos(angle) : radius * cos(angle));
    double sign = is_second ? 1.0 : -1.0; /* along the line is the vector to its right, turned by a right angle */
    spots[i] = (struct PicturePoint){spot.right - sign * outwards * way->up, spot.up + sign * outwards * way->right};
  }
  spots[POINTS] = spots[0];
  append_shape(drawing, LINK, false, spots, POINTS + 1);
}

/* Appends a circle about the first end through the second, and the spokes of a wheel. */
static void append_circle(struct Drawing *drawing, const struct View *view, const struct DrawnLine *line,
                          const double from[3], const double to[3]) {
  enum { ROUND = 36 };
  struct PicturePoint spots[ROUND + 1];
  double out[3], across[3];
  int first = (line->axis + 1) % 3, second = (line->axis + 2) % 3;
  for (int i = 0; i < 3; i++) out[i] = i == line->axis ? 0.0 : to[i] - from[i];
  across[line->axis] = 0.0;
  across[first] = -out[second];
  across[second] = out[first];
  for (int k = 0; k <= ROUND; k++) {
    double angle = 2.0 * acos(-1.0) * (k % ROUND) / ROUND, position[3];
    for (int i = 0; i < 3; i++) position[i] = from[i] + cos(angle) * out[i] + sin(angle) * across[i];
    spots[k] = seen(view, position);
  }
  append_shape(drawing, LINK, false, spots, ROUND + 1);
  for (int k = 0; k < ROUND / 2 && line->kind == LINE_WHEEL; k += ROUND / 4)
    append_line(drawing, ROPE, spots[k], spots[k + ROUND / 2]);
}

static void append_hatched(struct Drawing *drawing, const struct PictureLine *way, double size) {
  enum { HATCHES = 12 };
  double depth = 0.05 * size;
  int count = (int)fmin(fmax(way->length / depth / 1.5, 3.0), HATCHES);
  for (int i = 1; i <= count; i++)
    append_between(drawing, GROUND, way, (double[]){(double)i / count, 0.0},
                   (double[]){(double)i / count - fmin(depth / way->length, 1.0 / count), depth});
  append_line(drawing, GROUND, way->from, way->to);
}

static void append_support(struct Drawing *drawing, struct PicturePoint spot, double radius) {
  struct PicturePoint corners[4] = {spot,
                                    {spot.right - 0.8 * radius, spot.up - 1.3 * radius},
                                    {spot.right + 0.8 * radius, spot.up - 1.3 * radius},
                                    spot};
  append_shape(drawing, GROUND, true, corners, 3);
  append_shape(drawing, ROPE, false, corners, 4);
  append_shape(drawing, JOINT, true, &spot, 1);
}

static void append_arrow(struct Drawing *drawing, const struct PictureLine *way, double size) {
  double share = way->length > 0.0 ? 1.0 - fmin(0.08 * size / way->length, 0.5) : 1.0, aside = 0.03 * size;
  append_line(drawing, LINK, way->from, way->to);
  append_shape(drawing, LINK, false,
               (struct PicturePoint[]){spot_at(way, share, aside), way->to, spot_at(way, share, -aside)}, 3);
}

double *values_of_lines(const struct Model *model, const double *values) {
  const struct Graph *graph = model->drawing.graph;
  if (graph == NULL) return NULL;
  double *start = start_values(model), *symbols = allocate(graph->symbol_count, sizeof *symbols);
  for (size_t i = 0; i < graph->symbol_count && i < model->graph->symbol_count; i++) {
    const struct Symbol *symbol = &graph->symbols[i];
    symbols[i] = symbol->kind == COORDINATE ? values[symbol->node] : start[i];
  }
  double *found = graph_evaluate(graph, symbols);
  release(symbols);
  release(start);
  return found;
}

void position_of_end(const struct LineEnd *end, const double *line_values, double position[3]) {
  for (int i = 0; i < 3; i++) position[i] = line_values[end->position[i]];
}

void append_drawn_line(struct Drawing *drawing, const struct View *view, const struct DrawnLine *line,
                       const double *line_values, double size) {
  double ends[2][3], radius = line->radius_formula != NULL ? line_values[line->radius] : 0.04 * size, sum = radius;
  for (int end = 0; end < 2; end++) {
    position_of_end(&line->ends[has_two_ends(line) ? end : 0], line_values, ends[end]);
    for (int i = 0; i < 3; i++) sum += ends[end][i];
  }
  if (!isfinite(sum)) return;
  struct PictureLine way = way_between(seen(view, ends[0]), seen(view, ends[1]));
  switch (line->kind) {
  case LINE_ROD:
    if (line->radius_formula != NULL) append_thick(drawing, &way, radius);
    else append_line(drawing, LINK, way.from, way.to);
    break;
  case LINE_ROPE: append_line(drawing, ROPE, way.from, way.to); break;
  case LINE_SPRING: append_coil(drawing, &way, radius); break;
  case LINE_DAMPER: append_damper(drawing, &way, radius); break;
  case LINE_BELT: append_belt(drawing, &way, radius); break;
  case LINE_HOOP:
  case LINE_WHEEL: append_circle(drawing, view, line, ends[0], ends[1]); break;
  case LINE_GROUND: append_hatched(drawing, &way, size); break;
  case LINE_PIVOT: append_support(drawing, way.from, line->radius_formula != NULL ? radius : 0.07 * size); break;
  case LINE_ARROW: append_arrow(drawing, &way, size); break;
  }
}
