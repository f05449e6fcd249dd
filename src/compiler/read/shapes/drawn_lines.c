#include "read/shapes/drawn_lines.h"

#include <stdlib.h>
#include <string.h>

#include "algebra/formula.h"
#include "base/memory.h"
#include "read/space/bodies.h"
#include "read/space/frames.h"

/* Longest formula, in characters; a longer one takes too long to evaluate for each picture. */
enum { FORMULA_LIMIT = 4000 };

/* Symbols that an end may depend on. */
enum { IN_DRAWING = IN_FORCE };

static const char *const end_names[2] = {"from", "to"};

static unsigned bit(enum LineKind kind) {
  return 1u << kind;
}

static enum LineKind kind_of(xmlNodePtr node) {
  enum LineKind kind = LINE_ROD;
  for (size_t i = 0; i < LINE_KINDS; i++)
    if (attribute_is(node, "kind", line_kind_names[i])) kind = (enum LineKind)i;
  return kind; /* others are rejected by the schema */
}

static void check_attributes(struct Reader *reader, xmlNodePtr node, const struct DrawnLine *line) {
  const unsigned round = bit(LINE_HOOP) | bit(LINE_WHEEL), with_axis = round | bit(LINE_BELT),
                 without_radius = round | bit(LINE_GROUND) | bit(LINE_ROPE) | bit(LINE_ARROW);
  const char *kind = line_kind_names[line->kind];
  if (has_two_ends(line) && !has_attribute(node, "to"))
    report_at(reader, node, "the %s has no second end; expected to=\"...\"", kind);
  if (!has_two_ends(line) && has_attribute(node, "to"))
    report_at(reader, node, "a %s has one end; expected no 'to'", kind);
  if (line->kind == LINE_BELT && !has_attribute(node, "radius"))
    report_at(reader, node, "the belt has no radius; expected radius=\"...\" in m, that of its pulleys");
  if ((bit(line->kind) & without_radius) != 0 && has_attribute(node, "radius"))
    report_at(reader, node, "a %s has no radius of its own; expected none%s", kind,
              (bit(line->kind) & round) != 0 ? ", as it is the distance of its ends" : "");
  if ((bit(line->kind) & with_axis) == 0 && has_attribute(node, "axis"))
    report_at(reader, node, "a %s takes no axis; remove the attribute", kind);
}

/* Returns the length up to the next comma outside of parentheses and brackets. */
static size_t length_of_part(const char *text) {
  size_t length = 0;
  for (int depth = 0; text[length] != '\0' && (text[length] != ',' || depth > 0); length++)
    depth += (text[length] == '(' || text[length] == '[') - (text[length] == ')' || text[length] == ']');
  return length;
}

static Node read_length(struct Reader *reader, const char *text, struct Location location) {
  struct Quantity length = parse_expression(reader->scope, text, location);
  require_unit(reader, location.line, location.what, length, unit_of("m"));
  return without_displacements(reader, location.line, location.what, length.node);
}

/* Reads "x, y" or "x, y, z". */
static void read_list(struct Reader *reader, const char *text, struct Location location, struct LineEnd *end) {
  int count = 0;
  for (const char *next = text; next != NULL; count++) {
    size_t length = length_of_part(next);
    char *part = format_text("%.*s", (int)length, next);
    if (count < 3) end->position[count] = read_length(reader, part, location);
    next = next[length] == ',' ? next + length + 1 : NULL;
  }
  if (count > 3)
    report_error(reader->diagnostics, location.line, "%s has %d numbers; expected two or three, such as x, y",
                 location.what, count);
}

/* Reads a vector, as the arguments of dot(...) are. */
static void read_vector(struct Reader *reader, const char *text, struct Location location, struct LineEnd *end) {
  char *rest = NULL;
  strtod(text, &rest);
  if (*text != '\0' && *rest == '\0')
    report_error(reader->diagnostics, location.line,
                 "%s is a single number; expected two or three, such as x, y, or the name of a point", location.what);
  for (int i = 0; i < 3 && reader->diagnostics->errors == 0; i++)
    end->position[i] = read_length(reader, format_text("dot(%s, base.axis%c)", text, "XYZ"[i]), location);
}

/* True if the text is the name of a body, frame or point. */
static bool is_name(const struct Reader *reader, const char *name) {
  struct SpatialPoint point;
  return find_body(reader, name) != NULL || find_spatial_point(reader, name, &point);
}

/* Returns the name if the text is one; "" for the base, NULL for an expression. */
static const char *name_in(struct Reader *reader, const char *text, struct Location location) {
  if (strcmp(text, "base") == 0) return "";
  if (strpbrk(text, " \t\r\n,()+-*/") != NULL) return NULL;
  char *name = parse_name(reader->scope, text, location, true);
  if (name == NULL) return NULL;
  name = scope_full_name(reader->scope, name);
  return is_name(reader, name) ? name : NULL;
}

static void read_end(struct Reader *reader, xmlNodePtr node, const char *attribute_name, struct LineEnd *end) {
  char *text = attribute_in_lines(node, attribute_name);
  struct Location location = location_of(node, format_text("%s of <line>", attribute_name), IN_DRAWING);
  location.line = line_of_attribute(node, attribute_name);
  if (text == NULL) return;
  if (text[length_of_part(text)] == ',') read_list(reader, text, location, end);
  else read_vector(reader, text, location, end);
  if (reader->diagnostics->errors == 0) end->name = name_in(reader, text, location);
}

static void keep_line(struct LineDrawing *drawing, struct DrawnLine line) {
  APPEND(drawing->lines, drawing->count, line);
}

void draw_spring(struct Reader *reader, xmlNodePtr node) {
  struct DrawnLine line = {.kind = LINE_SPRING, .axis = 2, .is_guessed = true};
  line.line = scope_line(reader->scope, line_of(node));
  for (int i = 0; i < 2; i++) read_end(reader, node, end_names[i], &line.ends[i]);
  keep_line(&reader->model->drawing, line);
}

void read_line(struct Reader *reader, xmlNodePtr node) {
  struct DrawnLine line = {.kind = kind_of(node), .axis = 2, .color = attribute(node, "color"), .line = line_of(node)};
  check_attributes(reader, node, &line);
  reader->scope->keeps_whole = true;
  for (int i = 0; i < 2; i++) read_end(reader, node, end_names[i], &line.ends[i]);
  struct Quantity radius = {.node = ZERO};
  if (expression_attribute(reader, node, "radius", IN_MASS, &radius))
    require_unit(reader, line_of_attribute(node, "radius"), "radius", radius, unit_of("m"));
  reader->scope->keeps_whole = false;
  line.radius = radius.node;
  if (radius.node != ZERO) line.radius_formula = expression_text(reader->model->graph, radius.node);
  for (int i = 0; i < 3; i++)
    if (attribute_is(node, "axis", axes[i])) line.axis = i;
  line.has_trail = attribute_is(node, "trail", "true") || attribute_is(node, "trail", "1");
  line.line = scope_line(reader->scope, line.line);
  keep_line(&reader->model->drawing, line);
}

bool has_drawing(const struct Reader *reader) {
  bool has = false;
  for (size_t i = 0; i < reader->occurrence_count; i++) {
    const xmlNode *node = reader->occurrences[i].node;
    has |= is_element(node, "line") || is_element(node, "spring") || is_element(node, "task");
  }
  return has;
}

/* Returns the names of the expressions that are variables of the FMU. */
static struct NodeNames names_of_variables(const struct Model *model) {
  const struct VariableList *variables = &model->mechanism.element_variables;
  const struct Graph *graph = model->graph;
  struct NodeNames names = {.of = allocate(graph->count, sizeof *names.of), .count = graph->count};
  names.named = allocate(variables->count, sizeof *names.named);
  for (size_t i = 0; i < variables->count; i++) {
    Node node = variables->items[i].node;
    if (graph->vertices[node].operation == SYMBOL || graph_is_constant(graph, node) || names.of[node] != NULL) continue;
    names.of[node] = variables->items[i].name;
    names.named[names.named_count++] = node;
  }
  return names;
}

static void write_formulas(struct Reader *reader, const struct NodeNames *names, const struct DrawnLine *line,
                           struct LineEnd *end, const char *name) {
  for (int i = 0; i < 3; i++) {
    Node node = end->position[i];
    end->formula[i] =
        names->of[node] != NULL ? names->of[node] : expression_text_with_names(reader->model->graph, node, names);
    if (strlen(end->formula[i]) > FORMULA_LIMIT)
      report_error(reader->diagnostics, line->line,
                   "%s of <line> is a formula of more than %d characters; expected the name of a <point> there", name,
                   FORMULA_LIMIT);
  }
}

struct Scope *begin_drawing(struct Reader *reader) {
  struct Scope *scope = reader->scope, *drawing = allocate(1, sizeof *drawing);
  *drawing = *scope;
  drawing->graph = graph_copy(reader->model->graph);
  drawing->requirements = (struct Requirements){.count = 0};
  drawing->rates = (struct Derivatives){.capacity = 0};
  reader->scope = drawing;
  reader->model->drawing.graph = reader->model->graph; /* the model's own, until the end of the pass */
  reader->model->graph = drawing->graph;
  return scope;
}

static void check_radius(struct Reader *reader, const struct DrawnLine *line, const double *values) {
  if (line->radius_formula != NULL && !(values[line->radius] > 0.0))
    report_error(reader->diagnostics, line->line, "the radius of <line> is %g m; expected a positive number",
                 values[line->radius]);
}

/* Removes the springs of mechanics beside lines that the author describes. */
static void remove_guesses(struct LineDrawing *drawing) {
  size_t count = 0;
  if (!has_described_lines(drawing)) return;
  for (size_t i = 0; i < drawing->count; i++)
    if (!drawing->lines[i].is_guessed) drawing->lines[count++] = drawing->lines[i];
  drawing->count = count;
}

void end_drawing(struct Reader *reader, struct Scope *scope) {
  struct Model *model = reader->model;
  struct LineDrawing *drawing = &model->drawing;
  remove_guesses(drawing);
  struct NodeNames names = names_of_variables(model);
  double *values = graph_evaluate(model->graph, start_values(model));
  for (size_t i = 0; i < drawing->count && reader->diagnostics->errors == 0; i++) {
    struct DrawnLine *line = &drawing->lines[i];
    check_radius(reader, line, values);
    for (int end = 0; end < (has_two_ends(line) ? 2 : 1); end++)
      if (line->ends[end].name == NULL) write_formulas(reader, &names, line, &line->ends[end], end_names[end]);
  }
  release(values);
  if (graph_limit(model->graph) != NULL && reader->diagnostics->errors == 0)
    report_error(reader->diagnostics, 0, "the lines that are drawn are too large: %s; expected fewer or shorter ones",
                 graph_limit(model->graph));
  struct Graph *own = drawing->graph;
  drawing->graph = model->graph;
  model->graph = own;
  reader->scope = scope;
}
