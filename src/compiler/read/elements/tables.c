#include "read/elements/tables.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "algebra/simplify.h"
#include "base/memory.h"
#include "read/elements/grid_reader.h"
#include "read/tables/pieces.h"
#include "read/elements/table_lines.h"

enum { POINT_LIMIT = 500 };

struct Table {
  bool has_two_arguments;
  struct Curve curve;     /* of one */
  struct Surface surface; /* of two */
  bool is_constant_outside;
  struct Dimension arguments[2], value;
};

/* The points as they are read. */
struct Points {
  struct TableLines lines; /* the first member, from which take_line() comes to the others */
  struct Curve curve;
  size_t capacity_x, capacity_y;
};

static void append_point(struct Points *points, double x, double y) {
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
  curve->x = make_room(curve->x, curve->count, &points->capacity_x, sizeof *curve->x);
  curve->y = make_room(curve->y, curve->count, &points->capacity_y, sizeof *curve->y);
  curve->x[curve->count] = x;
  curve->y[curve->count++] = y;
}

static void take_line(struct TableLines *lines, const char *line) {
  size_t count;
  const char *rest;
  double *numbers = table_numbers(line, &count, &rest);
  if (count == 2 && *rest == '\0') append_point((struct Points *)lines, numbers[0], numbers[1]);
  else if (!lines->is_heading) {
    report_error(lines->reader->diagnostics, lines->line,
                 "'%.40s' is no point; expected two numbers, the argument and the value, such as 0.5 2", line);
    lines->wrong = true;
  }
  free(numbers);
}

/* <point x y/> or text. */
static void read_content(struct Points *points, xmlNodePtr node) {
  for (xmlNodePtr part = node->children; part != NULL; part = part->next) {
    points->lines.line = xmlGetLineNo(part);
    if (part->type == XML_ELEMENT_NODE) {
      double x = NAN, y = NAN;
      bool right = number_attribute(points->lines.reader, part, "x", &x);
      right = number_attribute(points->lines.reader, part, "y", &y) && right;
      if (right) append_point(points, x, y);
      points->lines.wrong |= !right;
    } else if (part->type == XML_TEXT_NODE) table_lines_of_text(&points->lines, part);
  }
}

static bool has_word(xmlNodePtr node, const char *name, const char *word) {
  char *text = attribute(node, name);
  bool same = text != NULL && strcmp(text, word) == 0;
  free(text);
  return same;
}

static enum Interpolation interpolation_of(xmlNodePtr node) {
  if (has_word(node, "interpolation", "spline")) return SPLINE;
  return has_word(node, "interpolation", "linear") ? LINEAR : MONOTONE;
}

static struct Table *create_table(struct Reader *reader, xmlNodePtr node) {
  struct Table *table = allocate(1, sizeof *table);
  *table = (struct Table){
      .is_constant_outside = has_word(node, "extrapolation", "constant"),
      .arguments = {unit_attribute(reader, node, "argumentUnit"), unit_attribute(reader, node, "secondArgumentUnit")},
      .value = unit_attribute(reader, node, "unit")};
  return table;
}

/* NULL after reporting what is wrong. */
static struct Table *read_curve(struct Reader *reader, xmlNodePtr node, const char *name, const char *file) {
  struct Points points = {.lines = {.reader = reader, .take = take_line}};
  if (file != NULL) table_lines_of_file(&points.lines, node, file);
  read_content(&points, node);
  if (!points.lines.wrong && points.curve.count < 2)
    report_error(reader->diagnostics, xmlGetLineNo(node),
                 "the table '%s' has %zu points; expected at least two, as <point x=\"0\" y=\"1\"/>, as lines of two "
                 "numbers, or in a file",
                 name, points.curve.count);
  if (points.lines.wrong || points.curve.count < 2) {
    curve_free(&points.curve);
    return NULL;
  }
  struct Table *table = create_table(reader, node);
  table->curve = points.curve;
  curve_interpolate(&table->curve, interpolation_of(node));
  return table;
}

static struct Table *read_surface(struct Reader *reader, xmlNodePtr node, const char *name, const char *file) {
  struct Surface surface = {0};
  if (!read_grid(reader, node, name, file, &surface)) {
    surface_free(&surface);
    return NULL;
  }
  struct Table *table = create_table(reader, node);
  table->has_two_arguments = true;
  table->surface = surface;
  surface_interpolate(&table->surface, interpolation_of(node));
  return table;
}

static void table_free(struct Table *table) {
  curve_free(&table->curve);
  surface_free(&table->surface);
}

void read_table(struct Reader *reader, xmlNodePtr node) {
  char *name = name_attribute(reader, node, "name"), *file = attribute(node, "file");
  struct Table *table = NULL;
  if (name != NULL)
    table = has_word(node, "arguments", "2") ? read_surface(reader, node, name, file)
                                             : read_curve(reader, node, name, file);
  /* A table is no value: its name alone cannot be used. */
  struct Quantity word = {.node = graph_constant(reader->model->graph, NAN)};
  bool is_new = name != NULL && scope_define(reader->scope, name, word, xmlGetLineNo(node));
  if (is_new && table != NULL) names_set(reader->scope->tables, name, table);
  else if (table != NULL) {
    table_free(table);
    free(table);
  }
  free(file);
  free(name);
}

const struct Table *table_named(const struct Scope *scope, const char *full_name) {
  return names_find(scope->tables, full_name);
}

bool table_has_two_arguments(const struct Table *table) {
  return table->has_two_arguments;
}

static bool check_argument(struct Parser *parser, struct Dimension unit, const char *name, const char *which,
                           struct Quantity argument) {
  if (argument.literal || scope_units_agree(parser->scope, argument.dimension, unit)) return true;
  char *actual = unit_text(argument.dimension), *expected = unit_text(unit);
  FAIL(parser, "%s: unit mismatch: the %sargument of '%s' has the unit %s, expected %s", parser->place.what, which,
       name, actual, expected);
  free(actual);
  free(expected);
  return false;
}

static Node polynomial(struct Graph *graph, const struct Curve *curve, size_t i, Node s) {
  Node inner = scale(graph, curve->d[i], s);
  inner = add(graph, graph_constant(graph, curve->c[i]), inner);
  inner = multiply(graph, s, inner);
  inner = add(graph, graph_constant(graph, curve->b[i]), inner);
  return multiply(graph, s, inner);
}

/* The first value and what each interval adds to it: its cubic of the way in it. */
static Node curve_at(struct Scope *scope, const struct Curve *curve, bool is_constant_outside, Node x) {
  struct Graph *graph = scope->graph;
  size_t last = curve->count - 1;
  Node value = graph_constant(graph, curve->y[0]);
  if (!is_constant_outside) value = add(graph, value, scale(graph, curve->b[0], way_before(scope, x, curve->x[0])));
  for (size_t i = 0; i < last; i++)
    value = add(graph, value, polynomial(graph, curve, i, way_in(scope, x, curve->x[i], curve->x[i + 1])));
  if (is_constant_outside) return value;
  return add(graph, value, scale(graph, curve->b[last], way_behind(scope, x, curve->x[last])));
}

struct Quantity table_at(struct Parser *parser, const struct Table *table, const char *name,
                         const struct Quantity arguments[2]) {
  struct Quantity value = {.node = ZERO, .dimension = table->value};
  bool outside = table->is_constant_outside, has_two = table->has_two_arguments;
  if (!check_argument(parser, table->arguments[0], name, has_two ? "first " : "", arguments[0])) return value;
  if (has_two && !check_argument(parser, table->arguments[1], name, "second ", arguments[1])) return value;
  parser->scope->table_line = current_line(parser);
  value.node = has_two ? surface_at(parser->scope, &table->surface, outside, arguments[0].node, arguments[1].node)
                       : curve_at(parser->scope, &table->curve, outside, arguments[0].node);
  return value;
}

void tables_free(struct Names *tables) {
  for (size_t i = 0; i < tables->capacity; i++)
    if (tables->places[i].text != NULL) table_free(tables->places[i].meaning);
  names_free(tables);
}
