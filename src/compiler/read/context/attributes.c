#include "read/context/attributes.h"

#include <string.h>

#include "algebra/differentiate.h"
#include "algebra/units/other_units.h"
#include "base/memory.h"
#include "mechanics/reactions.h"
#include "read/expressions/number_units.h"

void report_at(const struct Reader *reader, xmlNodePtr node, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  report_error_of(reader->diagnostics, line_of(node), format, arguments);
  va_end(arguments);
}

struct Location location_of(xmlNodePtr node, const char *what, unsigned kinds) {
  return (struct Location){
      .line = line_of(node), .what = what, .kinds = kinds, .input_derivatives = (kinds & WITH_RATES) != 0};
}

/* Returns the context of a number or a name in an attribute. */
static struct Location location_of_attribute(xmlNodePtr node, const char *name) {
  struct Location location = location_of(node, name, 0);
  location.line = line_of_attribute(node, name);
  return location;
}

bool number_in(struct Reader *reader, xmlNodePtr node, const char *name, const char *text, double *value) {
  return *text != '\0' && parse_number(reader->scope, text, location_of_attribute(node, name), value);
}

bool number_attribute(struct Reader *reader, xmlNodePtr node, const char *name, double *value) {
  char *text = attribute(node, name);
  return text != NULL && number_in(reader, node, name, text, value);
}

static char *full_name_in(struct Reader *reader, xmlNodePtr node, const char *name, bool parts) {
  char *text = attribute(node, name);
  if (text == NULL) return NULL;
  char *expanded = parse_name(reader->scope, text, location_of_attribute(node, name), parts);
  return expanded != NULL ? scope_full_name(reader->scope, expanded) : NULL;
}

char *name_attribute(struct Reader *reader, xmlNodePtr node, const char *name) {
  return full_name_in(reader, node, name, false);
}

char *reference_attribute(struct Reader *reader, xmlNodePtr node, const char *name) {
  return full_name_in(reader, node, name, true);
}

bool expression_attribute(struct Reader *reader, xmlNodePtr node, const char *name, unsigned kinds,
                          struct Quantity *value) {
  char *text = attribute_in_lines(node, name);
  if (text == NULL) return false;
  struct Location location = location_of(node, format_text("%s of <%s>", name, (const char *)node->name), kinds);
  location.line = line_of_attribute(node, name);
  if (*text != '\0') *value = parse_expression(reader->scope, text, location);
  return true;
}

Node without_displacements(struct Reader *reader, long line, const char *what, Node node) {
  struct Graph *graph = reader->model->graph;
  if (!graph_depends_on(graph, node, DISPLACEMENT)) return node;
  if (reader->undisplaced_count < graph->symbol_count) { /* expressions parsed since then may have added modes */
    reader->undisplaced = undisplaced_symbols(graph);
    reader->undisplaced_count = graph->symbol_count;
  }
  graph->not_finite = false;
  substitute(graph, &node, 1, reader->undisplaced, &node);
  if (graph->not_finite)
    report_error(reader->diagnostics, line,
                 "%s has no finite value where the displacements are 0; expected one, as they always are", what);
  return node;
}

struct Vector vector_without_displacements(struct Reader *reader, long line, const char *what, struct Vector vector) {
  for (int i = 0; i < 3; i++) vector.along[i] = without_displacements(reader, line, what, vector.along[i]);
  return vector;
}

struct Matrix matrix_without_displacements(struct Reader *reader, long line, const char *what, struct Matrix matrix) {
  for (int i = 0; i < 3; i++) matrix.row[i] = vector_without_displacements(reader, line, what, matrix.row[i]);
  return matrix;
}

Node add_energy(struct Reader *reader, xmlNodePtr node, const char *what, Node term, struct Quantity *displaced,
                struct Quantity *sum) {
  struct Model *model = reader->model;
  add_term(model, displaced, term);
  Node undisplaced = without_displacements(reader, line_of(node), what, term);
  add_term(model, sum, undisplaced);
  return undisplaced;
}

struct Quantity expression_text_of(struct Reader *reader, xmlNodePtr node, const char *what, unsigned kinds) {
  struct Location location = location_of(node, what, kinds);
  location.line = line_of_content(node);
  return parse_expression(reader->scope, text_of(node), location);
}

struct Quantity whole_expression_of(struct Reader *reader, xmlNodePtr node, const char *what, unsigned kinds) {
  reader->scope->keeps_whole = true;
  struct Quantity value = expression_text_of(reader, node, what, kinds);
  reader->scope->keeps_whole = false;
  return value;
}

char *next_listed(const char **text) {
  static const char separators[] = " \t\r\n,;";
  const char *begin = *text + strspn(*text, separators);
  size_t length = strcspn(begin, separators);
  *text = begin + length;
  return length > 0 ? format_text("%.*s", (int)length, begin) : NULL;
}

struct Dimension unit_attribute(struct Reader *reader, xmlNodePtr node, const char *name) {
  struct Dimension dimension = dimension_unknown;
  const char *problem;
  char *text = attribute(node, name);
  if (text != NULL && !unit_parse(text, &dimension, &problem)) {
    char *remedy = unit_remedy(text);
    report_at(reader, node, "the unit '%s' is not known; %s", text, remedy != NULL ? remedy : problem);
  }
  reader->scope->checks_units |= text != NULL;
  return dimension;
}

void require_unit(struct Reader *reader, long line, const char *what, struct Quantity quantity,
                  struct Dimension expected) {
  if (quantity.literal || scope_units_agree(reader->scope, quantity.dimension, expected)) return;
  char *problem = format_text("unit mismatch: %s has the unit %s, expected %s", what, unit_text(quantity.dimension),
                              unit_text(expected));
  if (!number_may_have_unit(reader->scope, line, quantity, expected, problem))
    report_error(reader->diagnostics, line, "%s%s", problem, unit_hint(quantity.dimension));
}

static void append_expectation(struct Reader *reader, struct Expectation expectation) {
  size_t count = reader->expectation_count++;
  reader->expectations = make_room(reader->expectations, count, sizeof *reader->expectations);
  reader->expectations[count] = expectation;
}

void expect_not_negative(struct Reader *reader, xmlNodePtr node, const char *what, Node value, bool is_required) {
  long line = scope_line(reader->scope, line_of(node));
  append_expectation(reader, (struct Expectation){value, line, what, is_required, false});
}

void expect_size(struct Reader *reader, xmlNodePtr node, const char *what, Node value, bool is_required) {
  long line = scope_line(reader->scope, line_of(node));
  append_expectation(reader, (struct Expectation){value, line, what, is_required, true});
}
