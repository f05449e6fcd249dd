#include "read/elements/grid_reader.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "read/elements/table_lines.h"

/* Largest number of values of a table; the size of its expression is proportional to it. */
enum { VALUE_LIMIT = 1000 };

/* A table of two arguments while its lines are read. */
struct Grid {
  struct TableLines lines; /* first member, so that take_line() can cast to struct Grid */
  struct SurfaceTable *surface;
};

/* True if the knot is finite and larger than the previous one; reports an error otherwise. */
static bool check_knot(struct Grid *grid, const double *knots, size_t i) {
  if (isfinite(knots[i]) && (i == 0 || knots[i] > knots[i - 1])) return true;
  report_error(grid->lines.reader->diagnostics, grid->lines.line,
               "the knot %g does not follow %g; expected finite numbers, each larger than the one before it", knots[i],
               i > 0 ? knots[i - 1] : 0.0);
  grid->lines.wrong = true;
  return false;
}

static bool check_value(struct Grid *grid, double value) {
  if (isfinite(value)) return true;
  report_error(grid->lines.reader->diagnostics, grid->lines.line,
               "the value %g is not finite; expected numbers below 1e308", value);
  grid->lines.wrong = true;
  return false;
}

static bool check_size(struct Grid *grid) {
  if ((grid->surface->rows + 1) * grid->surface->columns <= VALUE_LIMIT) return true;
  report_error(grid->lines.reader->diagnostics, grid->lines.line, "the table has more than %d values; expected fewer",
               VALUE_LIMIT);
  grid->lines.wrong = true;
  return false;
}

/* Reads the knots of the first argument. A word in the corner before them is skipped. */
static void take_head(struct Grid *grid, const char *line) {
  struct SurfaceTable *surface = grid->surface;
  const char *rest = line;
  if (!isdigit((unsigned char)*line) && strchr("+-.", *line) == NULL) rest += strcspn(line, " \t,;");
  rest += strspn(rest, " \t,;");
  surface->x = table_numbers(rest, &surface->columns, &rest);
  if (*rest == '\0' && surface->columns > 0) return;
  report_error(grid->lines.reader->diagnostics, grid->lines.line,
               "'%.40s' is not a number; expected the knots of the first argument in the first line", rest);
  grid->lines.wrong = true;
}

/* Removes the corner from the first line: it is a number if the lines below are as long as the first one. */
static void drop_corner(struct SurfaceTable *surface) {
  surface->columns--;
  memmove(surface->x, surface->x + 1, surface->columns * sizeof *surface->x);
}

static void append_row(struct Grid *grid, const double *numbers) {
  struct SurfaceTable *surface = grid->surface;
  size_t columns = surface->columns, first = surface->rows * columns;
  surface->y = make_room(surface->y, surface->rows, sizeof *surface->y);
  surface->y[surface->rows] = numbers[0];
  if (!check_knot(grid, surface->y, surface->rows)) return;
  for (size_t i = 0; i < columns; i++) {
    surface->value = make_room(surface->value, first + i, sizeof *surface->value);
    surface->value[first + i] = numbers[i + 1];
    if (!check_value(grid, numbers[i + 1])) return;
  }
  surface->rows++;
}

static void take_row(struct Grid *grid, const char *line) {
  struct SurfaceTable *surface = grid->surface;
  size_t count;
  const char *rest;
  double *numbers = table_numbers(line, &count, &rest);
  if (surface->rows == 0 && count == surface->columns && count > 1 && *rest == '\0') drop_corner(surface);
  bool is_right = true;
  for (size_t i = 0; i < surface->columns && surface->rows == 0 && is_right; i++)
    is_right = check_knot(grid, surface->x, i);
  if (is_right && (*rest != '\0' || count != surface->columns + 1)) {
    report_error(grid->lines.reader->diagnostics, grid->lines.line,
                 "'%.40s' has %zu numbers; expected %zu, a knot of the second argument and the values there for all "
                 "of the first one",
                 line, count, surface->columns + 1);
    grid->lines.wrong = true;
  } else if (is_right && check_size(grid)) append_row(grid, numbers);
}

static void take_line(struct TableLines *lines, const char *line) {
  struct Grid *grid = (struct Grid *)lines;
  if (grid->surface->columns == 0) take_head(grid, line);
  else take_row(grid, line);
}

bool read_grid(struct Reader *reader, xmlNodePtr node, const char *name, const char *file,
               struct SurfaceTable *surface) {
  struct Grid grid = {.lines = {.reader = reader, .take = take_line}, .surface = surface};
  if (file != NULL) table_lines_of_file(&grid.lines, node, file);
  for (xmlNodePtr part = node->children; part != NULL; part = part->next) {
    if (part->type == XML_TEXT_NODE) table_lines_of_text(&grid.lines, part);
    if (part->type != XML_ELEMENT_NODE || grid.lines.wrong) continue;
    report_error(reader->diagnostics, line_of(part),
                 "the table '%s' of two arguments has a <point>; expected lines, or a file", name);
    grid.lines.wrong = true;
  }
  if (grid.lines.wrong) return false;
  if (surface->columns >= 2 && surface->rows >= 2) return true;
  report_error(
      reader->diagnostics, line_of(node),
      "the table '%s' has %zu x %zu values; expected at least two knots of each argument: a line with the knots of "
      "the first, then for each knot of the second a line with the knot and its values",
      name, surface->columns, surface->rows);
  return false;
}
