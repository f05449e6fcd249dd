#include "line_drawing.h"

#include <math.h>

#include "base/memory.h"

/* A line in the picture: points are given by the share of its length, and by the distance to its right in m. */
struct PictureLine {
  struct PicturePoint from, to;
  double right, up; /* unit vector to its right */
  double length;    /* in m */
};

static struct PictureLine line_between(struct PicturePoint from, struct PicturePoint to) {
  double right = to.right - from.right, up = to.up - from.up, length = hypot(right, up);
  if (!(length > 0.0)) return (struct PictureLine){from, to, 1.0, 0.0, 0.0};
  return (struct PictureLine){from, to, up / length, -right / length, length};
}

static struct PicturePoint point_of_line(const struct PictureLine *axis_line, double share, double aside) {
  return (struct PicturePoint){
      axis_line->from.right + share * (axis_line->to.right - axis_line->from.right) + aside * axis_line->right,
      axis_line->from.up + share * (axis_line->to.up - axis_line->from.up) + aside * axis_line->up};
}

static void append_between(struct Drawing *drawing, enum Look look, const struct PictureLine *axis_line,
                           const double from[2], const double to[2]) {
  append_line(drawing, look, point_of_line(axis_line, from[0], from[1]), point_of_line(axis_line, to[0], to[1]));
}

/* Appends a rod of a given radius. */
static void append_thick(struct Drawing *drawing, const struct PictureLine *axis_line, double radius) {
  struct PicturePoint corners[5] = {point_of_line(axis_line, 0.0, radius), point_of_line(axis_line, 1.0, radius),
                                    point_of_line(axis_line, 1.0, -radius), point_of_line(axis_line, 0.0, -radius),
                                    point_of_line(axis_line, 0.0, radius)};
  append_shape(drawing, SOLID, true, corners, 4);
  append_shape(drawing, EDGE, false, corners, 5);
}

static void append_coil(struct Drawing *drawing, const struct PictureLine *axis_line, double radius) {
  enum { TURNS = 12 };
  struct PicturePoint points[TURNS + 4];
  points[0] = axis_line->from;
  points[1] = point_of_line(axis_line, 0.12, 0.0);
  for (int i = 0; i < TURNS; i++)
    points[2 + i] = point_of_line(axis_line, 0.12 + 0.76 * (i + 0.5) / TURNS, i % 2 == 0 ? radius : -radius);
  points[TURNS + 2] = point_of_line(axis_line, 0.88, 0.0);
  points[TURNS + 3] = axis_line->to;
  append_shape(drawing, ROPE, false, points, TURNS + 4);
}

static void append_damper(struct Drawing *drawing, const struct PictureLine *axis_line, double radius) {
  struct PicturePoint housing[4] = {point_of_line(axis_line, 0.65, radius), point_of_line(axis_line, 0.2, radius),
                                    point_of_line(axis_line, 0.2, -radius), point_of_line(axis_line, 0.65, -radius)};
  append_line(drawing, ROPE, axis_line->from, point_of_line(axis_line, 0.2, 0.0));
  append_shape(drawing, ROPE, false, housing, 4);
  append_between(drawing, LINK, axis_line, (double[]){0.5, -0.8 * radius}, (double[]){0.5, 0.8 * radius});
  append_line(drawing, ROPE, point_of_line(axis_line, 0.5, 0.0), axis_line->to);
}

/* Appends two half circles and the straight parts between them. */
static void append_belt(struct Drawing *drawing, const struct PictureLine *axis_line, double radius) {
  enum { HALF = 12, POINTS = 2 * (HALF + 1) };
  struct PicturePoint points[POINTS + 1];
  for (int i = 0; i < POINTS; i++) {
    bool is_second = i > HALF;
    double angle = acos(-1.0) * (is_second ? i - HALF - 1 : i) / HALF, outwards = radius * sin(angle);
    struct PicturePoint point =
        point_of_line(axis_line, is_second, is_second ? -radius * cos(angle) : radius * cos(angle));
    double sign = is_second ? 1.0 : -1.0; /* along the line is the vector to its right, turned by a right angle */
    points[i] = (struct PicturePoint){point.right - sign * outwards * axis_line->up,
                                      point.up + sign * outwards * axis_line->right};
  }
  points[POINTS] = points[0];
  append_shape(drawing, LINK, false, points, POINTS + 1);
}

/* Appends a circle about the first end through the second, and the spokes of a wheel. */
static void append_circle(struct Drawing *drawing, const struct View *view, const struct DrawnLine *line,
                          const double from[3], const double to[3]) {
  enum { ROUND = 36 };
  struct PicturePoint points[ROUND + 1];
  double out[3], across[3];
  int first = (line->axis + 1) % 3, second = (line->axis + 2) % 3;
  for (int i = 0; i < 3; i++) out[i] = i == line->axis ? 0.0 : to[i] - from[i];
  across[line->axis] = 0.0;
  across[first] = -out[second];
  across[second] = out[first];
  for (int k = 0; k <= ROUND; k++) {
    double angle = 2.0 * acos(-1.0) * (k % ROUND) / ROUND, position[3];
    for (int i = 0; i < 3; i++) position[i] = from[i] + cos(angle) * out[i] + sin(angle) * across[i];
    points[k] = projected(view, position);
  }
  append_shape(drawing, LINK, false, points, ROUND + 1);
  for (int k = 0; k < ROUND / 2 && line->kind == LINE_WHEEL; k += ROUND / 4)
    append_line(drawing, ROPE, points[k], points[k + ROUND / 2]);
}

static void append_hatched(struct Drawing *drawing, const struct PictureLine *axis_line, double size) {
  enum { HATCHES = 12 };
  double depth = 0.05 * size;
  int count = (int)fmin(fmax(axis_line->length / depth / 1.5, 3.0), HATCHES);
  for (int i = 1; i <= count; i++)
    append_between(drawing, GROUND, axis_line, (double[]){(double)i / count, 0.0},
                   (double[]){(double)i / count - fmin(depth / axis_line->length, 1.0 / count), depth});
  append_line(drawing, GROUND, axis_line->from, axis_line->to);
}

static void append_support(struct Drawing *drawing, struct PicturePoint point, double radius) {
  struct PicturePoint corners[4] = {point,
                                    {point.right - 0.8 * radius, point.up - 1.3 * radius},
                                    {point.right + 0.8 * radius, point.up - 1.3 * radius},
                                    point};
  append_shape(drawing, GROUND, true, corners, 3);
  append_shape(drawing, ROPE, false, corners, 4);
  append_shape(drawing, JOINT, true, &point, 1);
}

static void append_arrow(struct Drawing *drawing, const struct PictureLine *axis_line, double size) {
  double share = axis_line->length > 0.0 ? 1.0 - fmin(0.08 * size / axis_line->length, 0.5) : 1.0, aside = 0.03 * size;
  append_line(drawing, LINK, axis_line->from, axis_line->to);
  append_shape(drawing, LINK, false,
               (struct PicturePoint[]){point_of_line(axis_line, share, aside), axis_line->to,
                                       point_of_line(axis_line, share, -aside)},
               3);
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
  struct PictureLine axis_line = line_between(projected(view, ends[0]), projected(view, ends[1]));
  switch (line->kind) {
  case LINE_ROD:
    if (line->radius_formula != NULL) append_thick(drawing, &axis_line, radius);
    else append_line(drawing, LINK, axis_line.from, axis_line.to);
    break;
  case LINE_ROPE: append_line(drawing, ROPE, axis_line.from, axis_line.to); break;
  case LINE_SPRING: append_coil(drawing, &axis_line, radius); break;
  case LINE_DAMPER: append_damper(drawing, &axis_line, radius); break;
  case LINE_BELT: append_belt(drawing, &axis_line, radius); break;
  case LINE_HOOP:
  case LINE_WHEEL: append_circle(drawing, view, line, ends[0], ends[1]); break;
  case LINE_GROUND: append_hatched(drawing, &axis_line, size); break;
  case LINE_PIVOT: append_support(drawing, axis_line.from, line->radius_formula != NULL ? radius : 0.07 * size); break;
  case LINE_ARROW: append_arrow(drawing, &axis_line, size); break;
  }
}
