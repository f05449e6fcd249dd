#include "read/event_checks.h"

#include <math.h>

#include "algebra/cone.h"

/* Samples of an expression: at the start, 1 s and 2 s later. */
enum { TIMES = 3 };

/* Relative rounding error of the second difference of an expression that is affine in time. */
static const double rounding = 1e-12;

static bool is_set_by(const struct Event *event, Node mode) {
  bool is_set = false;
  for (size_t i = 0; i < event->assignment_count; i++) is_set |= event->assignments[i].symbol == mode;
  return is_set;
}

/*
 * True if the event's expression depends only on time, parameters and modes that no other event sets. The graph's cone
 * holds the expression's nodes.
 */
static bool is_alone(const struct Model *model, const struct Event *event) {
  const unsigned may_use = 1u << TIME | 1u << PARAMETER | 1u << MODE;
  const struct Graph *graph = model->graph;
  bool is_alone = (graph->vertices[event->expression].kinds & ~may_use) == 0;
  for (size_t i = 0; i < model->switches.branch_count; i++)
    is_alone &= !cone_has(graph->cone, model->switches.branches[i].mode);
  for (size_t i = 0; i < model->switches.event_count; i++)
    for (size_t j = 0; j < model->modes.count && &model->switches.events[i] != event; j++)
      is_alone &= !cone_has(graph->cone, model->modes.items[j].node) ||
                  !is_set_by(&model->switches.events[i], model->modes.items[j].node);
  return is_alone;
}

static void evaluate(const struct Model *model, Node expression, double *value) {
  double *symbols = start_values(model);
  for (size_t i = 0; i < model->modes.count; i++)
    symbols[model->graph->vertices[model->modes.items[i].node].left] = model->modes.items[i].start;
  for (int i = 0; i < TIMES; i++) {
    value[i] = graph_evaluate(model->graph, symbols)[expression];
    symbols[model->graph->vertices[model->time].left] += 1.0;
  }
}

static void warn_of_event(const struct Reader *reader, const struct Event *event) {
  double value[TIMES];
  evaluate(reader->model, event->expression, value);
  double rate = value[1] - value[0], change = value[2] - value[1] - rate;
  bool is_affine = fabs(change) <= rounding * (fabs(value[0]) + fabs(value[1]) + fabs(value[2]));
  if (!is_affine || rate == 0.0) return;
  bool rises = rate > 0.0, comes_to_zero = value[0] * rate < 0.0;
  bool looks_there = event->passage == PASSAGE_BOTH || (event->passage == PASSAGE_RISES) == rises;
  const char *course = rises ? "rises" : "falls";
  if (!comes_to_zero)
    report_warning(
        reader->diagnostics, event->line,
        "the event never happens: when=\"%s\" is %g at the start and %s, away from 0; expected <sample every=\"...\"> "
        "for an event at the start and then periodically, or an expression that crosses 0 later",
        event->text, value[0], course);
  else if (!looks_there)
    report_warning(reader->diagnostics, event->line,
                   "the event never happens: when=\"%s\" only %s; expected direction=\"%s\"", event->text, course,
                   rises ? "rising" : "falling");
}

void warn_of_events(const struct Reader *reader) {
  const struct Model *model = reader->model;
  for (size_t i = 0; i < model->switches.event_count; i++) {
    const struct Event *event = &model->switches.events[i];
    if (event->expression == ZERO) continue;
    cone_collect(model->graph->cone, model->graph, &event->expression, 1);
    if (cone_has(model->graph->cone, model->time) && is_alone(model, event)) warn_of_event(reader, event);
  }
}
