#include <string.h>

#include "algebra/cone.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "read/elements/switching_reader.h"
#include "read/expressions/constructs.h"
#include "names/piecewise_functions.h"

/* Kinds of symbols in conditions and assignments of events. */
enum { IN_EVENT = IN_CONDITION | KIND(ACCELERATION) | CONTACT_STATE };

static const struct {
  const char *attribute;
  enum SymbolKind kind;
} targets[] = {{"velocity", VELOCITY}, {"coordinate", COORDINATE}, {"state", STATE}, {"mode", MODE}};
enum { TARGET_COUNT = sizeof targets / sizeof *targets };

/* Reports a name of another kind than that of the attribute, or an unknown one. */
static void report_target(struct Reader *reader, xmlNodePtr node, const char *attribute, const char *name,
                          const struct Symbol *symbol) {
  for (size_t i = 0; i < TARGET_COUNT && symbol != NULL; i++)
    if (symbol->kind == targets[i].kind) {
      report_at(reader, node, "<set %s=\"%s\">: '%s' is a %s; expected <set %s=\"%s\">", attribute, name, name,
                targets[i].attribute, targets[i].attribute, name);
      return;
    }
  report_at(reader, node, "<set %s=\"%s\">: there is no %s of this name; expected an existing name", attribute, name,
            attribute);
}

/* Returns the symbol that a <set> assigns: a coordinate, velocity, state or mode. ZERO after reporting an error. */
static Node target_of(struct Reader *reader, xmlNodePtr node) {
  size_t given = 0;
  Node symbol = ZERO;
  for (size_t i = 0; i < TARGET_COUNT; i++) {
    if (!has_attribute(node, targets[i].attribute)) continue;
    given++;
    char *name = reference_attribute(reader, node, targets[i].attribute);
    const struct Quantity *quantity = name != NULL ? scope_find(reader->scope, name) : NULL;
    const struct Graph *graph = reader->model->graph;
    bool is_symbol = quantity != NULL && graph->vertices[quantity->node].operation == SYMBOL;
    const struct Symbol *found = is_symbol ? graph_symbol_of(graph, quantity->node) : NULL;
    if (found != NULL && found->kind == targets[i].kind) symbol = quantity->node;
    else report_target(reader, node, targets[i].attribute, name != NULL ? name : "", found);
  }
  if (given != 1)
    report_at(reader, node, "a <set> has %zu of velocity, coordinate, state and mode; expected one", given);
  return symbol;
}

static void check_target(struct Reader *reader, xmlNodePtr node, const struct Event *event, Node symbol) {
  const struct Symbol *target = graph_symbol_of(reader->model->graph, symbol);
  bool is_state = target->kind == COORDINATE || target->kind == VELOCITY;
  if (is_state && reader->model->prescribed.motions[target->index].is_prescribed)
    report_at(reader, node, "'%s' of <set> is a driven coordinate; expected one without an acceleration", target->name);
  for (size_t i = 0; i < event->assignment_count; i++)
    if (event->assignments[i].symbol == symbol)
      report_at(reader, node, "'%s' is set twice in one <%s>; expected one <set> of it", target->name,
                (const char *)node->parent->name);
}

static void append_assignment(struct Event *event, Node symbol, Node value) {
  APPEND(event->assignments, event->assignment_count, (struct Assignment){symbol, value});
}

/* True if the author has given no unit to the mode, which is then a pure number. */
static bool is_mode_without_unit(const struct Model *model, Node symbol) {
  for (size_t i = 0; i < model->modes.count; i++)
    if (model->modes.items[i].node == symbol) return model->modes.items[i].unit == NULL;
  return false;
}

static void check_unit_of_value(struct Reader *reader, xmlNodePtr node, Node symbol, struct Quantity value) {
  const char *name = graph_symbol_of(reader->model->graph, symbol)->name;
  const struct Quantity *target = scope_find(reader->scope, name);
  if (target == NULL || !target->dimension.known) return;
  bool fits = value.literal || scope_units_agree(reader->scope, value.dimension, target->dimension);
  if (!fits && is_mode_without_unit(reader->model, symbol))
    report_at(
        reader, node,
        "unit mismatch: the value of <set> has the unit %s, but '%s' has none; expected unit=\"%s\" of its <mode>",
        unit_text(value.dimension), name, unit_text(value.dimension));
  else require_unit(reader, line_of(node), "the value of <set>", value, target->dimension);
}

static void read_assignment(struct Reader *reader, xmlNodePtr node, struct Event *event) {
  Node symbol = target_of(reader, node);
  bool is_of_sample = event->passage == PASSAGE_SAMPLES; /* its values need no events */
  struct Quantity value = (is_of_sample ? whole_expression_of : expression_text_of)(reader, node, "the value of <set>",
                                                                                    IN_EVENT | AT_INSTANT);
  if (symbol == ZERO || reader->diagnostics->errors > 0) return;
  check_target(reader, node, event, symbol);
  check_unit_of_value(reader, node, symbol, value);
  append_assignment(event, symbol, value.node);
}

static bool is_boolean_parameter(const struct Reader *reader, Node node) {
  const struct Graph *graph = reader->model->graph;
  if (graph->vertices[node].operation != SYMBOL) return false;
  const struct Symbol *symbol = graph_symbol_of(graph, node);
  return symbol->kind == PARAMETER && reader->model->parameters.items[symbol->index].type == TYPE_BOOLEAN;
}

/*
 * Returns a condition as a function of only modes, so that an event can compare it before and after parameters are
 * set. A condition of modes and parameters becomes the sign of a number that is 1/2 if it holds, else -1/2.
 */
static Node condition_of_modes(struct Reader *reader, Node value, long line) {
  struct Graph *graph = reader->model->graph;
  if (!graph_depends_on(graph, value, PARAMETER)) return value;
  if (!graph_depends_on(graph, value, MODE)) return condition_of_parameters(reader->scope, value, line);
  Node holds = function(graph, GUARD, value, ONE), half = graph_constant(graph, 0.5);
  return condition_of_parameters(reader->scope, subtract(graph, holds, half), line);
}

/* Reads a condition, whose change to true is the event, or an expression with the direction of its zero crossing. */
static void read_condition(struct Reader *reader, xmlNodePtr node, const char *when, struct Event *event) {
  struct Graph *graph = reader->model->graph;
  struct Location location = {.line = line_of_attribute(node, "when"), .what = "when", .kinds = IN_EVENT};
  char *direction = attribute(node, "direction");
  int errors = reader->diagnostics->errors;
  Node value;
  bool is_given = parse_when(reader->scope, attribute_in_lines(node, "when"), location, &value);
  event->line = scope_line(reader->scope, location.line);
  if (is_given || is_boolean_parameter(reader, value)) {
    event->condition = condition_of_modes(reader, value, location.line);
    if (direction != NULL)
      report_at(
          reader, node,
          "the when of an <event> is a condition, which has no direction; expected an expression that passes 0, or "
          "no direction");
  } else if (value != ZERO) {
    event->condition = last_sign_of(reader->scope, value, location.line);
    event->last_sign = new_mode(reader, "side", when);
    event->expression = value;
    bool rises = direction != NULL && strcmp(direction, "rising") == 0;
    bool is_both = direction != NULL && strcmp(direction, "both") == 0;
    event->passage = is_both ? PASSAGE_BOTH : rises ? PASSAGE_RISES : PASSAGE_FALLS;
  }
  bool is_read = reader->diagnostics->errors == errors;
  if (is_read && !graph_depends_on(graph, event->condition, MODE))
    report_at(
        reader, node,
        "when=\"%s\" never changes; expected an expression of coordinates, velocities, inputs, parameters or time",
        when);
}

/* Collects in the graph's cone all nodes that an event depends on, including the switching functions of its modes. */
static void collect_event(const struct Reader *reader, const struct Event *event) {
  const struct Graph *graph = reader->model->graph;
  const struct Switches *switches = &reader->model->switches;
  Node *roots = allocate(event->assignment_count + 1 + switches->branch_count, sizeof *roots);
  size_t count = 0, before = 0;
  roots[count++] = event->condition;
  for (size_t i = 0; i < event->assignment_count; i++) roots[count++] = event->assignments[i].value;
  size_t first = count;
  while (count > before) {
    cone_collect(graph->cone, graph, roots, count);
    before = count;
    count = first;
    for (size_t i = 0; i < switches->branch_count; i++)
      if (cone_has(graph->cone, switches->branches[i].mode)) roots[count++] = switches->branches[i].indicator;
  }
}

static const char *words_for(const struct Event *event) {
  return event->passage == PASSAGE_SAMPLES ? "a <sample>" : "an <event>";
}

/*
 * Reports events that depend on accelerations of coordinates. Of symbols of this kind only the forces of contacts,
 * frictions and constraints are allowed.
 */
static void check_forces(const struct Reader *reader, struct Event *event, long line) {
  const struct Model *model = reader->model;
  unsigned kinds = deciding_kinds(reader->scope, event->condition);
  event->is_of_contacts = (kinds & (KIND(ACCELERATION) | CONTACT_STATE)) != 0;
  for (size_t i = 0; i < event->assignment_count; i++)
    kinds |= deciding_kinds(reader->scope, event->assignments[i].value);
  if ((kinds & KIND(ACCELERATION)) == 0) return;
  collect_event(reader, event);
  for (size_t i = 0; i < model->coordinates.count; i++)
    if (cone_has(model->graph->cone, model->unknowns.accelerations[i]))
      report_error(reader->diagnostics, line,
                   "%s cannot depend on accelerations, but this one does on '%s'; expected velocities, or the "
                   "force of a contact, a friction or a constraint such as ground.force",
                   words_for(event), graph_symbol_of(model->graph, model->unknowns.accelerations[i])->name);
}

/* Reads each <set> of an event or a sample. */
static void read_assignments(struct Reader *reader, xmlNodePtr node, struct Event *event) {
  for (xmlNodePtr child = node->children; child != NULL; child = child->next)
    if (child->type == XML_ELEMENT_NODE) read_assignment(reader, child, event);
  if (event->assignment_count == 0 && reader->diagnostics->errors == 0)
    report_at(reader, node, "%s changes nothing; expected a <set> in it", words_for(event));
  if (reader->diagnostics->errors == 0) check_forces(reader, event, line_of(node));
}

static void append_event(struct Reader *reader, const struct Event *event) {
  struct Switches *switches = &reader->model->switches;
  APPEND(switches->events, switches->event_count, *event);
}

/* True if the system is read for a linearization, which has no events. */
static bool is_linearized(const struct Reader *reader) {
  return reader->scope->switches == NULL;
}

void read_event(struct Reader *reader, xmlNodePtr node) {
  if (is_linearized(reader)) return;
  struct Event event = {.passage = PASSAGE_HOLDS, .text = attribute(node, "when")};
  if (event.text == NULL) return;
  read_condition(reader, node, event.text, &event);
  read_assignments(reader, node, &event);
  append_event(reader, &event);
}

/* Reads a time of parameters and modes from an attribute. */
static Node read_time(struct Reader *reader, xmlNodePtr node, const char *name) {
  struct Quantity time = {.node = ZERO};
  if (expression_attribute(reader, node, name, KIND(PARAMETER) | KIND(MODE), &time))
    require_unit(reader, line_of_attribute(node, name), name, time, unit_of("s"));
  return time.node;
}

/*
 * Advances the sample at time base + count period. If the period was changed since the previous sample, the present
 * time becomes the base, and the new period counts from there.
 */
static void count_on(struct Graph *graph, struct Event *event) {
  const struct SampleClock *sample = &event->sample;
  Node present = add(graph, sample->base, multiply(graph, sample->count, sample->period));
  Node change = function(graph, ABSOLUTE, subtract(graph, sample->every, sample->period), ZERO);
  append_assignment(event, sample->base, choose_node(graph, change, present, sample->base));
  append_assignment(event, sample->count, choose_node(graph, change, ONE, add(graph, sample->count, ONE)));
  append_assignment(event, sample->period, sample->every);
}

void read_sample(struct Reader *reader, xmlNodePtr node) {
  if (is_linearized(reader)) return;
  struct Graph *graph = reader->model->graph;
  struct Event event = {
      .passage = PASSAGE_SAMPLES, .text = attribute(node, "every"), .line = scope_line(reader->scope, line_of(node))};
  if (event.text == NULL) return;
  struct SampleClock *sample = &event.sample;
  sample->every = read_time(reader, node, "every");
  sample->offset = read_time(reader, node, "offset");
  expect_size(reader, node, "every of <sample>", sample->every, true);
  sample->base = new_mode(reader, "sample", "base");
  sample->count = new_mode(reader, "sample", "count");
  sample->period = new_mode(reader, "sample", "period");
  Node next = add(graph, sample->base, multiply(graph, sample->count, sample->period));
  Node left = subtract(graph, next, scope_find(reader->scope, "time")->node);
  sample->branch = condition_of_parameters(reader->scope, left, line_of(node));
  event.condition = subtract(graph, ONE, function(graph, GUARD, sample->branch, ONE));
  read_assignments(reader, node, &event);
  count_on(graph, &event);
  append_event(reader, &event);
}
