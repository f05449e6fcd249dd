#include "read/tables.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "algebra/simplify.h"
#include "memory.h"
#include "read/curve.h"
#include "read/includes.h"

enum { POINT_LIMIT = 500 };

struct Table {
  struct Curve curve;
  bool is_constant_outside;
  struct Dimension argument, value;
};

/* The points as they are read; limit: more than that are told of once. */
struct Points {
  struct Reader *reader;
  struct Curve curve;
  size_t capacity_x, capacity_y;
  long line; /* of the present one */
  bool wrong;
};

static void append_point(struct Points *points, double x, double y) {
  struct Curve *curve = &points->curve;
  struct Diagnostics *diagnostics = points->reader->diagnostics;
  if (points->wrong) return;
  points->wrong = true;
  if (!isfinite(x) || !isfinite(y)) {
    report_error(diagnostics, points->line, "the point (%g, %g) is not finite; expected numbers below 1e308", x, y);
    return;
  }
  if (curve->count > 0 && !(x > curve->x[curve->count - 1])) {
    report_error(diagnostics, points->line,
                 "the point at %g follows that at %g; expected points from left to right, each argument once", x,
                 curve->x[curve->count - 1]);
    return;
  }
  if (curve->count == POINT_LIMIT) {
    report_error(diagnostics, points->line, "the table has more than %d points; expected fewer", POINT_LIMIT);
    return;
  }
  points->wrong = false;
  curve->x = make_room(curve->x, curve->count, &points->capacity_x, sizeof *curve->x);
  curve->y = make_room(curve->y, curve->count, &points->capacity_y, sizeof *curve->y);
  curve->x[curve->count] = x;
  curve->y[curve->count++] = y;
}

/* "0.5, 2" or "0.5 2" or "0.5;2"; false where it is none of these. */
static bool parse_line(const char *line, double *x, double *y) {
  static const char blanks[] = " \t\r";
  char *end;
  *x = strtod(line, &end);
  if (end == line) return false;
  const char *next = end + strspn(end, blanks);
  if (*next == ',' || *next == ';') next++;
  else if (next == end) return false;
  *y = strtod(next, &end);
  return end != next && end[strspn(end, blanks)] == '\0';
}

/* Each line a point; what follows # is a comment, and the first line may be a heading. */
static void read_lines(struct Points *points, const char *text, bool may_have_heading) {
  bool is_first = may_have_heading;
  while (*text != '\0' && !points->wrong) {
    size_t length = strcspn(text, "\n"), used = 0;
    char *line = format_text("%.*s", (int)length, text);
    line[strcspn(line, "#")] = '\0';
    double x, y;
    used = strspn(line, " \t\r");
    if (line[used] != '\0' && parse_line(line, &x, &y)) append_point(points, x, y);
    else if (line[used] != '\0' && !is_first) {
      report_error(points->reader->diagnostics, points->line,
                   "'%.40s' is no point; expected two numbers, the argument and the value, such as 0.5 2", line + used);
      points->wrong = true;
    }
    is_first = is_first && line[used] == '\0';
    free(line);
    text += length;
    points->line += *text == '\n';
    text += *text == '\n';
  }
}

static char *text_of_file(const char *path) {
  FILE *file = fopen(path, "r");
  if (file == NULL) return NULL;
  char *text = NULL;
  size_t length = 0;
  FILE *copy = open_text(&text, &length);
  for (int c = getc(file); c != EOF && c != '\0'; c = getc(file)) putc(c, copy);
  bool right = ferror(file) == 0;
  fclose(file);
  fclose(copy);
  if (right) return text;
  free(text);
  return NULL;
}

/* Messages name the file and its lines while it is read. */
static void read_file(struct Points *points, xmlNodePtr node, const char *name) {
  struct Diagnostics *diagnostics = points->reader->diagnostics;
  char *path = path_beside(points->reader, name), *text = text_of_file(path);
  if (text == NULL) {
    report_error(diagnostics, xmlGetLineNo(node),
                 "the file '%s' cannot be read: %s; expected two columns of numbers, its path relative to this file",
                 path, strerror(errno));
    points->wrong = true;
  } else {
    const char *present = diagnostics->file;
    diagnostics->file = path;
    points->line = 1;
    read_lines(points, text, true);
    diagnostics->file = present;
  }
  free(text);
  free(path);
}

/* <point x y/> or text; the line of a text is that of its end. */
static void read_content(struct Points *points, xmlNodePtr node) {
  for (xmlNodePtr part = node->children; part != NULL; part = part->next) {
    points->line = xmlGetLineNo(part);
    if (part->type == XML_ELEMENT_NODE) {
      double x = NAN, y = NAN;
      bool right = number_attribute(points->reader, part, "x", &x);
      right = number_attribute(points->reader, part, "y", &y) && right;
      if (right) append_point(points, x, y);
      points->wrong |= !right;
    } else if (part->type == XML_TEXT_NODE) {
      const char *text = (const char *)part->content;
      for (const char *c = text; *c != '\0'; c++) points->line -= *c == '\n';
      read_lines(points, text, false);
    }
  }
}

static bool has_word(xmlNodePtr node, const char *name, const char *word) {
  char *text = attribute(node, name);
  bool same = text != NULL && strcmp(text, word) == 0;
  free(text);
  return same;
}

static struct Table *create_table(struct Reader *reader, xmlNodePtr node, struct Curve curve) {
  struct Table *table = allocate(1, sizeof *table);
  enum Interpolation interpolation = has_word(node, "interpolation", "spline")   ? SPLINE
                                     : has_word(node, "interpolation", "linear") ? LINEAR
                                                                                 : MONOTONE;
  *table = (struct Table){.curve = curve,
                          .is_constant_outside = has_word(node, "extrapolation", "constant"),
                          .argument = unit_attribute(reader, node, "argumentUnit"),
                          .value = unit_attribute(reader, node, "unit")};
  curve_interpolate(&table->curve, interpolation);
  return table;
}

void read_table(struct Reader *reader, xmlNodePtr node) {
  char *name = name_attribute(reader, node, "name"), *file = attribute(node, "file");
  struct Points points = {.reader = reader};
  if (file != NULL) read_file(&points, node, file);
  read_content(&points, node);
  if (!points.wrong && points.curve.count < 2)
    report_error(reader->diagnostics, xmlGetLineNo(node),
                 "the table '%s' has %zu points; expected at least two, as <point x=\"0\" y=\"1\"/>, as lines of two "
                 "numbers, or in a file",
                 name, points.curve.count);
  /* A table is no value: its name alone cannot be used. */
  struct Quantity word = {.node = graph_constant(reader->model->graph, NAN)};
  bool is_right = name != NULL && !points.wrong && points.curve.count >= 2;
  if (name != NULL && scope_define(reader->scope, name, word, xmlGetLineNo(node)) && is_right) {
    names_set(reader->scope->tables, name, create_table(reader, node, points.curve));
  } else curve_free(&points.curve);
  free(file);
  free(name);
}

const struct Table *table_named(const struct Scope *scope, const char *full_name) {
  return names_find(scope->tables, full_name);
}

static bool check_argument(struct Parser *parser, const struct Table *table, const char *name,
                           struct Quantity argument) {
  if (argument.literal || scope_units_agree(parser->scope, argument.dimension, table->argument)) return true;
  char *actual = unit_text(argument.dimension), *expected = unit_text(table->argument);
  FAIL(parser, "%s: unit mismatch: the argument of '%s' has the unit %s, expected %s", parser->place.what, name, actual,
       expected);
  free(actual);
  free(expected);
  return false;
}

/*
 * Where two pieces meet, min and max give the left operand's derivative: so the first piece to the right counts at a
 * point, and each point belongs to one piece.
 */
static Node way_in(struct Graph *graph, const struct Curve *curve, size_t i, Node x) {
  Node from_start = function(graph, MAXIMUM, subtract(graph, x, graph_constant(graph, curve->x[i])), ZERO);
  return function(graph, MINIMUM, graph_constant(graph, curve->x[i + 1] - curve->x[i]), from_start);
}

static Node polynomial(struct Graph *graph, const struct Curve *curve, size_t i, Node s) {
  Node inner = add(graph, graph_constant(graph, curve->c[i]), scale(graph, curve->d[i], s));
  inner = add(graph, graph_constant(graph, curve->b[i]), multiply(graph, s, inner));
  return multiply(graph, s, inner);
}

struct Quantity table_at(struct Parser *parser, const struct Table *table, const char *name, struct Quantity argument) {
  struct Graph *graph = parser->graph;
  const struct Curve *curve = &table->curve;
  size_t last = curve->count - 1;
  struct Quantity value = {.node = graph_constant(graph, curve->y[0]), .dimension = table->value};
  if (!check_argument(parser, table, name, argument)) return value;
  if (!table->is_constant_outside) {
    Node before = subtract(graph, argument.node, graph_constant(graph, curve->x[0]));
    value.node = add(graph, value.node, scale(graph, curve->b[0], function(graph, MINIMUM, ZERO, before)));
  }
  for (size_t i = 0; i < last; i++)
    value.node = add(graph, value.node, polynomial(graph, curve, i, way_in(graph, curve, i, argument.node)));
  if (!table->is_constant_outside) {
    Node after = subtract(graph, argument.node, graph_constant(graph, curve->x[last]));
    value.node = add(graph, value.node, scale(graph, curve->b[last], function(graph, MAXIMUM, after, ZERO)));
  }
  return value;
}

void tables_free(struct Names *tables) {
  for (size_t i = 0; i < tables->capacity; i++)
    if (tables->places[i].text != NULL) curve_free(&((struct Table *)tables->places[i].meaning)->curve);
  names_free(tables);
}
