/* <event> and <set>. */
#include <string.h>

#include "algebra/cone.h"
#include "base/memory.h"
#include "read/elements/switching_reader.h"
#include "read/expressions/comparisons.h"
#include "read/names/pieces_of_functions.h"

enum { IN_EVENT = IN_CONDITION | KIND(ACCELERATION) | CONTACT_STATE };

/* What <set> changes: the symbol of a coordinate, velocity, state or mode. */
static Node target_of(struct Reader *reader, xmlNodePtr node) {
  static const struct {
    const char *attribute;
    enum SymbolKind kind;
  } targets[] = {{"velocity", VELOCITY}, {"coordinate", COORDINATE}, {"state", STATE}, {"mode", MODE}};
  size_t given = 0;
  Node symbol = ZERO;
  for (size_t i = 0; i < sizeof targets / sizeof *targets; i++) {
    if (!has_attribute(node, targets[i].attribute)) continue;
    given++;
    char *name = reference_attribute(reader, node, targets[i].attribute);
    const struct Quantity *quantity = name != NULL ? scope_find(reader->scope, name) : NULL;
    const struct Graph *graph = reader->model->graph;
    bool fits = quantity != NULL && graph->vertices[quantity->node].operation == SYMBOL &&
                graph_symbol_of(graph, quantity->node)->kind == targets[i].kind;
    if (fits) symbol = quantity->node;
    else
      report_at(reader, node, "<set %s=\"%s\">: there is no %s of this name", targets[i].attribute,
                name != NULL ? name : "", targets[i].attribute);
  }
  if (given != 1) report_at(reader, node, "a <set> needs one of velocity, coordinate, state and mode");
  return symbol;
}

static void check_target(struct Reader *reader, xmlNodePtr node, const struct Event *event, Node symbol) {
  const struct Symbol *target = graph_symbol_of(reader->model->graph, symbol);
  bool is_state = target->kind == COORDINATE || target->kind == VELOCITY;
  if (is_state && reader->model->given.drives[target->index].given)
    report_at(reader, node, "<set> of '%s', which is driven; expected another one", target->name);
  for (size_t i = 0; i < event->assignment_count; i++)
    if (event->assignments[i].symbol == symbol)
      report_at(reader, node, "a second <set> of '%s' in one <event>; expected one", target->name);
}

static void read_assignment(struct Reader *reader, xmlNodePtr node, struct Event *event) {
  Node symbol = target_of(reader, node);
  struct Quantity value = expression_text_of(reader, node, "the value of <set>", IN_EVENT);
  if (symbol == ZERO || reader->diagnostics->errors > 0) return;
  check_target(reader, node, event, symbol);
  const char *name = graph_symbol_of(reader->model->graph, symbol)->name;
  const struct Quantity *target = scope_find(reader->scope, name);
  if (target != NULL && target->dimension.known)
    require_unit(reader, line_of(node), "the value of <set>", value, target->dimension);
  event->assignments = make_room(event->assignments, event->assignment_count, sizeof *event->assignments);
  event->assignments[event->assignment_count++] = (struct Assignment){symbol, value.node};
}

/* A condition that comes to hold, or an expression that passes 0 in a direction. */
static void read_condition(struct Reader *reader, xmlNodePtr node, const char *when, struct Event *event) {
  struct Graph *graph = reader->model->graph;
  struct Place place = {.line = line_of_attribute(node, "when"), .what = "when", .kinds = IN_EVENT};
  char *direction = attribute(node, "direction");
  Node value;
  if (parse_when(reader->scope, attribute_in_lines(node, "when"), place, &value)) {
    bool is_tuned = graph_is_constant_in_time(graph, value) && rests_on_parameters(graph, value);
    event->condition = is_tuned ? tuned_condition(reader->scope, value, place.line) : value;
    if (direction != NULL)
      report_at(reader, node,
                "an <event> whose when is a condition, with a direction; expected an expression that passes 0, or "
                "no direction");
  } else if (value != ZERO) {
    event->condition = side_of(reader->scope, value, place.line);
    event->side = new_mode(reader, "side", when);
    bool rises = direction != NULL && strcmp(direction, "rising") == 0;
    bool is_both = direction != NULL && strcmp(direction, "both") == 0;
    event->passage = is_both ? PASSAGE_BOTH : rises ? PASSAGE_RISES : PASSAGE_FALLS;
  }
  if (event->condition != ZERO && !graph_depends_on(graph, event->condition, MODE))
    report_at(
        reader, node,
        "when=\"%s\" never changes; expected an expression of coordinates, velocities, inputs, parameters or time",
        when);
}

/* Collects in the graph's cone what an event rests on, also by what decides on its pieces. */
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

/* Of accelerations, an event may look at the forces of contacts, frictions and constraints alone. */
static void check_forces(const struct Reader *reader, struct Event *event, long line) {
  const struct Model *model = reader->model;
  unsigned kinds = kinds_that_decide(reader->scope, event->condition);
  event->is_of_contacts = (kinds & (KIND(ACCELERATION) | CONTACT_STATE)) != 0;
  for (size_t i = 0; i < event->assignment_count; i++)
    kinds |= kinds_that_decide(reader->scope, event->assignments[i].value);
  if ((kinds & KIND(ACCELERATION)) == 0) return;
  collect_event(reader, event);
  for (size_t i = 0; i < model->coordinates.count; i++)
    if (cone_has(model->graph->cone, model->unknowns.accelerations[i]))
      report_error(reader->diagnostics, line,
                   "an <event> cannot depend on accelerations, but this one does on '%s'; expected velocities, or the "
                   "force of a contact, a friction or a constraint such as ground.force",
                   graph_symbol_of(model->graph, model->unknowns.accelerations[i])->name);
}

void read_event(struct Reader *reader, xmlNodePtr node) {
  struct Switches *switches = &reader->model->switches;
  char *when = attribute(node, "when");
  if (when == NULL) return;
  struct Event event = {.passage = PASSAGE_HOLDS};
  read_condition(reader, node, when, &event);
  for (xmlNodePtr child = node->children; child != NULL; child = child->next)
    if (child->type == XML_ELEMENT_NODE) read_assignment(reader, child, &event);
  if (event.assignment_count == 0 && reader->diagnostics->errors == 0)
    report_at(reader, node, "an <event> that changes nothing; expected a <set>");
  if (reader->diagnostics->errors == 0) check_forces(reader, &event, line_of(node));
  event.text = when;
  switches->events = make_room(switches->events, switches->event_count, sizeof *switches->events);
  switches->events[switches->event_count++] = event;
}
