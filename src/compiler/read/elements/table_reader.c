#include "read/context/readers.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "read/elements/grid_reader.h"
#include "read/elements/table_lines.h"
#include "read/tables/table.h"

/* Largest number of points of a table; each needs a mode. */
enum { POINT_LIMIT = 500 };

/* Collects the points of a table of one argument. */
struct TablePoints {
  struct TableLines lines; /* first member, so that take_line() can cast to struct TablePoints */
  struct Curve curve;
};

static void append_point(struct TablePoints *points, double x, double y) {
  struct Curve *curve = &points->curve;
  struct Diagnostics *diagnostics = points->lines.reader->diagnostics;
  if (points->lines.wrong) return;
  points->lines.wrong = true;
  if (!isfinite(x) || !isfinite(y)) {
    report_error(diagnostics, points->lines.line, "the point (%g, %g) is not finite; expected numbers below 1e308", x,
                 y);
    return;
  }
  if (curve->count > 0 && !(x > curve->x[curve->count - 1])) {
    report_error(diagnostics, points->lines.line,
                 "the point at %g follows that at %g; expected points from left to right, each argument once", x,
                 curve->x[curve->count - 1]);
    return;
  }
  if (curve->count == POINT_LIMIT) {
    report_error(diagnostics, points->lines.line, "the table has more than %d points; expected fewer", POINT_LIMIT);
    return;
  }
  points->lines.wrong = false;
  curve->x = make_room(curve->x, curve->count, sizeof *curve->x);
  curve->y = make_room(curve->y, curve->count, sizeof *curve->y);
  curve->x[curve->count] = x;
  curve->y[curve->count++] = y;
}

static void take_line(struct TableLines *lines, const char *line) {
  size_t count;
  const char *rest;
  double *numbers = table_numbers(line, &count, &rest);
  if (count == 2 && *rest == '\0') append_point((struct TablePoints *)lines, numbers[0], numbers[1]);
  else if (!lines->is_heading) {
    report_error(lines->reader->diagnostics, lines->line,
                 "'%.40s' is not a point; expected two numbers, the argument and the value, such as 0.5 2", line);
    lines->wrong = true;
  }
}

/* Reads <point x y/> elements or lines of text. */
static void read_content(struct TablePoints *points, xmlNodePtr node) {
  for (xmlNodePtr part = node->children; part != NULL; part = part->next) {
    points->lines.line = line_of(part);
    if (part->type == XML_ELEMENT_NODE) {
      double x = NAN, y = NAN;
      bool right = number_attribute(points->lines.reader, part, "x", &x);
      right = number_attribute(points->lines.reader, part, "y", &y) && right;
      if (right) append_point(points, x, y);
      points->lines.wrong |= !right;
    } else if (part->type == XML_TEXT_NODE) table_lines_of_text(&points->lines, part);
  }
}

static enum Interpolation interpolation_of(xmlNodePtr node) {
  if (attribute_is(node, "interpolation", "spline")) return SPLINE;
  return attribute_is(node, "interpolation", "linear") ? LINEAR : MONOTONE;
}

static struct Table *create_table(struct Reader *reader, xmlNodePtr node) {
  struct Table *table = allocate(1, sizeof *table);
  *table = (struct Table){
      .is_constant_outside = attribute_is(node, "extrapolation", "constant"),
      .arguments = {unit_attribute(reader, node, "argumentUnit"), unit_attribute(reader, node, "secondArgumentUnit")},
      .value = unit_attribute(reader, node, "unit")};
  return table;
}

/* Returns the table; NULL after reporting an error. */
static struct Table *read_curve(struct Reader *reader, xmlNodePtr node, const char *name, const char *file) {
  struct TablePoints points = {.lines = {.reader = reader, .take = take_line}};
  if (file != NULL) table_lines_of_file(&points.lines, node, file);
  read_content(&points, node);
  if (!points.lines.wrong && points.curve.count < 2)
    report_at(
        reader, node,
        "the table '%s' has too few points (%zu); expected at least two, as <point x=\"0\" y=\"1\"/>, as lines of two "
        "numbers, or in a file",
        name, points.curve.count);
  if (points.lines.wrong || points.curve.count < 2) return NULL;
  struct Table *table = create_table(reader, node);
  table->curve = points.curve;
  curve_interpolate(&table->curve, interpolation_of(node));
  return table;
}

static struct Table *read_surface(struct Reader *reader, xmlNodePtr node, const char *name, const char *file) {
  struct SurfaceTable surface = {0};
  if (!read_grid(reader, node, name, file, &surface)) return NULL;
  struct Table *table = create_table(reader, node);
  table->has_two_arguments = true;
  table->surface = surface;
  surface_interpolate(&table->surface, interpolation_of(node));
  return table;
}

void read_table(struct Reader *reader, xmlNodePtr node) {
  char *name = name_attribute(reader, node, "name"), *file = attribute(node, "file");
  struct Table *table = NULL;
  if (name != NULL)
    table = attribute_is(node, "arguments", "2") ? read_surface(reader, node, name, file)
                                                 : read_curve(reader, node, name, file);
  /* A table has no value without arguments: NAN reserves its name. */
  struct Quantity word = {.node = graph_constant(reader->model->graph, NAN)};
  bool is_new = name != NULL && scope_define(reader->scope, name, word, line_of(node));
  if (is_new && table != NULL) names_set(reader->scope->tables, name, table);
}
