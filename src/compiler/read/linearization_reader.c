#include "read/stages.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "names/similar.h"
#include "base/paths.h"
#include "read/context/value_texts.h"
#include "read/elements/elements.h"
#include "read/expressions/number_units.h"
#include "read/expressions/parser.h"

char *linearized_path(xmlNodePtr root, const char *path) {
  char *of = attribute(root, "of");
  if (of == NULL) return NULL;
  return path_beside_file(path, of);
}

/* Removes the state of <work/>, which a linearization does not have. */
static void remove_work(struct Model *model) {
  struct Graph *graph = model->graph;
  size_t kept = 0;
  for (size_t i = 0; i < model->states.count; i++) {
    if (model->states.items[i].is_work) continue;
    graph->symbols[graph->vertices[model->states.items[i].node].left].index = (int)kept;
    model->states.items[kept++] = model->states.items[i];
  }
  model->states.count = kept;
}

static void begin_point(struct Model *model) {
  remove_work(model);
  model->linearized = true;
  model->point.values = allocate(model->graph->symbol_count, sizeof *model->point.values);
  model->point.given = allocate(model->graph->symbol_count, sizeof *model->point.given);
}

/* Returns a number with a unit, as a number of the variable's unit. */
static Node number_at(struct Model *model, const char *name, const char *value, struct Dimension dimension,
                      struct Diagnostics *diagnostics) {
  double number = 0.0;
  const char *unit = dimension.known ? unit_text(dimension) : "1";
  value_of_option(format_text("--at %s", name), value, unit, diagnostics, &number);
  return graph_constant(model->graph, number);
}

static void set_point(struct Model *model, struct Scope *scope, const char *name, const char *value, long line,
                      struct Diagnostics *diagnostics) {
  const struct Quantity *quantity = scope_find(scope, name);
  bool is_symbol = quantity != NULL && model->graph->vertices[quantity->node].operation == SYMBOL;
  enum SymbolKind kind = is_symbol ? graph_symbol_of(model->graph, quantity->node)->kind : PARAMETER;
  if (kind != COORDINATE && kind != VELOCITY && kind != STATE && kind != INPUT) {
    const char *similar = quantity == NULL ? scope_similar_name(scope, name) : NULL;
    report_error(diagnostics, line, "the operating point sets '%s'%s; %s", name,
                 similar != NULL ? ", which does not exist" : "",
                 suggestion(similar, "expected a coordinate, a velocity, a state or an input"));
    return;
  }
  Node symbol = model->graph->vertices[quantity->node].left;
  if (model->point.given[symbol])
    report_error(diagnostics, line, "the operating point sets '%s' twice; expected one value", name);
  struct Dimension dimension = quantity->dimension;
  struct Location location = {.line = line, .what = name, .kinds = 1u << PARAMETER};
  struct Quantity parsed = {.dimension = dimension};
  if (line == 0 && value_has_unit(value)) parsed.node = number_at(model, name, value, dimension, diagnostics);
  else parsed = parse_expression(scope, value, location);
  const char *problem = format_text("unit mismatch: the value for '%s' has another unit than the variable", name);
  if (!parsed.literal && !scope_units_agree(scope, parsed.dimension, dimension) &&
      !number_may_have_unit(scope, line, parsed, dimension, problem))
    report_error(diagnostics, line, "%s", problem);
  model->point.values[symbol] = parsed.node;
  model->point.given[symbol] = true;
}

void apply_point(struct Model *model, struct Scope *scope, const char *const *point, size_t count,
                 struct Diagnostics *diagnostics) {
  if (model->linearized) {
    report_error(diagnostics, 0, "this file is a linearization already; expected a <system> for --linearize");
    return;
  }
  scope->diagnostics = diagnostics;
  begin_point(model);
  for (size_t i = 0; i < count; i++) {
    const char *equals = strchr(point[i], '=');
    char *name = format_text("%.*s", equals != NULL ? (int)(equals - point[i]) : 0, point[i]);
    if (equals == NULL) report_error(diagnostics, 0, "--at %s names no value; expected NAME=VALUE", point[i]);
    else set_point(model, scope, name, equals + 1, 0, diagnostics);
  }
}

void read_linearization(struct Model *model, struct Scope *scope, xmlNodePtr root, struct Diagnostics *diagnostics) {
  struct Reader reader = {.model = model, .scope = scope, .diagnostics = diagnostics};
  scope->diagnostics = diagnostics;
  model->name = attribute(root, "name");
  model->description = attribute(root, "description");
  model->solver.method = NULL;
  model->solver.max_step = model->solver.max_steps = NAN;
  begin_point(model);
  for (xmlNodePtr node = root->children; node != NULL; node = node->next) {
    if (node->type != XML_ELEMENT_NODE) continue;
    if (strcmp((const char *)node->name, "solver") == 0) read_solver(&reader, node);
    else if (strcmp((const char *)node->name, "experiment") == 0) read_experiment(&reader, node);
    else {
      char *name = reference_attribute(&reader, node, "name"), *value = attribute(node, "value");
      if (name != NULL && value != NULL) set_point(model, scope, name, value, line_of(node), diagnostics);
    }
  }
}
