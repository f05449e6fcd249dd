#include "read/stages.h"

#include <math.h>
#include <stdlib.h>

#include "algebra/cone.h"
#include "algebra/differentiate.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "read/bounds.h"
#include "read/condition_outcomes.h"

static bool is_set_by(const struct Event *event, Node mode) {
  bool is_set = false;
  for (size_t i = 0; i < event->assignment_count; i++) is_set |= event->assignments[i].symbol == mode;
  return is_set;
}

/* Counts the branches, contacts and frictions whose modes are in the cone of the graph. */
static size_t count_switches(const struct Model *model) {
  const struct Switches *switches = &model->switches;
  const struct Cone *cone = model->graph->cone;
  size_t count = 0;
  for (size_t i = 0; i < switches->branch_count; i++) count += cone_has(cone, switches->branches[i].mode);
  for (size_t i = 0; i < switches->contact_count; i++) count += cone_has(cone, switches->contacts[i].mode);
  for (size_t i = 0; i < switches->friction_count; i++) count += cone_has(cone, switches->frictions[i].reported);
  return count;
}

/* True if the nodes in the cone of the graph depend only on time, parameters and modes that no other event sets. */
static bool is_alone(const struct Model *model, const struct Event *event) {
  const struct Graph *graph = model->graph;
  bool is_alone = cone_has(graph->cone, model->time);
  for (size_t i = 0; i < graph->cone->count; i++) {
    Node node = graph->cone->nodes[i];
    if (graph->vertices[node].operation != SYMBOL) continue;
    enum SymbolKind kind = graph_symbol_of(graph, node)->kind;
    is_alone &= kind == TIME || kind == PARAMETER || kind == MODE;
  }
  for (size_t i = 0; i < model->switches.event_count; i++)
    for (size_t j = 0; j < model->modes.count && &model->switches.events[i] != event; j++)
      is_alone &= !cone_has(graph->cone, model->modes.items[j].node) ||
                  !is_set_by(&model->switches.events[i], model->modes.items[j].node);
  return is_alone;
}

/* An expression of time: bounds at the start, and of its time derivative from then on, for all parameters in their ranges. */
struct Course {
  struct Bounds start, rate;
};

/* Returns bounds of an expression of time at these times, while modes have their start values. */
static struct Bounds bounds_at(const struct Model *model, Node expression, struct Bounds times) {
  size_t count = model->modes.count;
  struct KnownBounds *known = allocate(count + 1, sizeof *known);
  known[count] = (struct KnownBounds){model->time, times};
  for (size_t i = 0; i < count; i++) {
    const struct Variable *mode = &model->modes.items[i];
    bool varies = mode->start_expression != ZERO && !graph_is_constant(model->graph, mode->start_expression);
    struct Bounds start = {mode->start, mode->start};
    known[i] = (struct KnownBounds){mode->node, varies ? bounds_of(model, mode->start_expression, NULL, 0) : start};
  }
  return bounds_of(model, expression, known, count + 1);
}

static struct Course course_of(const struct Model *model, Node expression) {
  double start = isnan(model->experiment.start_time) ? 0.0 : model->experiment.start_time;
  Node rate = derivative_by(model->graph, expression, model->time);
  return (struct Course){bounds_at(model, expression, (struct Bounds){start, start}),
                         bounds_at(model, rate, (struct Bounds){start, INFINITY})};
}

static bool is_single(struct Bounds bounds) {
  return bounds.low == bounds.high;
}

static void warn_of_event(const struct Reader *reader, const struct Model *model, const struct Event *event) {
  struct Course course = course_of(model, event->expression);
  struct Bounds start = course.start, rate = course.rate;
  bool rises = rate.low >= 0.0, falls = rate.high <= 0.0;
  if (rises == falls) return; /* constant, or of no known direction */
  bool leaves_zero = rises ? start.low >= 0.0 : start.high <= 0.0;
  bool looks_there = event->passage == PASSAGE_BOTH || (event->passage == PASSAGE_RISES) == rises;
  const char *direction = rises ? "rises" : "falls";
  if (leaves_zero)
    report_warning(
        reader->diagnostics, event->line,
        "the event never happens: when=\"%s\" is %g at the start and %s, away from 0; expected <sample every=\"...\"> "
        "for an event at the start and then periodically, or an expression that crosses 0 later",
        event->text, graph_evaluate(model->graph, start_values(model))[event->expression], direction);
  else if (!looks_there)
    report_warning(reader->diagnostics, event->line,
                   "the event never happens: when=\"%s\" only %s; expected direction=\"%s\"", event->text, direction,
                   rises ? "rising" : "falling");
}

/* The branches of a condition, and the times after the start at which they switch. */
struct BranchTimes {
  const struct Branch **branches;
  double *times;
  size_t branch_count, time_count;
};

static int compare_times(const void *first, const void *second) {
  double a = *(const double *)first, b = *(const double *)second;
  return (a > b) - (a < b);
}

/*
 * Finds the branches and their times. False if a branch depends on others, or is not affine in time, or if other values
 * of parameters give other times or another condition.
 */
static bool find_branch_times(const struct Model *model, const struct Event *event, struct BranchTimes *branch_times) {
  const struct Switches *switches = &model->switches;
  struct Cone *cone = model->graph->cone;
  Node *roots = allocate(switches->branch_count + 1, sizeof *roots);
  cone_collect(cone, model->graph, &event->condition, 1);
  roots[0] = event->condition;
  for (size_t i = 0; i < model->parameters.count; i++)
    if (cone_has(cone, model->parameters.items[i].node)) return false;
  for (size_t i = 0; i < switches->branch_count; i++)
    if (cone_has(cone, switches->branches[i].mode)) {
      branch_times->branches[branch_times->branch_count++] = &switches->branches[i];
      roots[branch_times->branch_count] = switches->branches[i].indicator;
    }
  cone_collect(cone, model->graph, roots, branch_times->branch_count + 1);
  if (count_switches(model) != branch_times->branch_count || !is_alone(model, event)) return false;
  for (size_t i = 0; i < branch_times->branch_count; i++) {
    struct Course course = course_of(model, branch_times->branches[i]->indicator);
    if (!is_single(course.start) || !is_single(course.rate) || course.rate.low == 0.0) return false;
    double duration = -course.start.low / course.rate.low;
    if (duration > 0.0) branch_times->times[branch_times->time_count++] = duration;
  }
  qsort(branch_times->times, branch_times->time_count, sizeof *branch_times->times, compare_times);
  return true;
}

/* True if the condition holds at a duration after the start. */
static bool holds_at(const struct Model *model, const struct Event *event, const struct BranchTimes *branch_times,
                     double duration) {
  double *symbols = start_values(model);
  symbols[model->graph->vertices[model->time].left] += duration;
  const double *value = graph_evaluate(model->graph, symbols);
  for (size_t i = 0; i < branch_times->branch_count; i++) {
    double indicator = value[branch_times->branches[i]->indicator];
    symbols[model->graph->vertices[branch_times->branches[i]->mode].left] = (indicator > 0.0) - (indicator < 0.0);
  }
  return graph_evaluate(model->graph, symbols)[event->condition] > 0.0;
}

static void warn_of_condition(const struct Reader *reader, const struct Model *model, const struct Event *event) {
  size_t count = model->switches.branch_count;
  struct BranchTimes branch_times = {.branches = allocate(count, sizeof(const struct Branch *)),
                                     .times = allocate(count, sizeof(double))};
  if (!find_branch_times(model, event, &branch_times)) return;
  bool at_start = holds_at(model, event, &branch_times, 0.0), before = at_start;
  double passed = 0.0;
  for (size_t i = 0; i <= branch_times.time_count; i++) {
    double next = i < branch_times.time_count ? branch_times.times[i] : passed + 2.0;
    bool holds = holds_at(model, event, &branch_times, (passed + next) / 2.0);
    if (holds && !before) return;
    before = holds;
    passed = next;
  }
  report_warning(reader->diagnostics, event->line,
                 "the event never happens: when=\"%s\" %s; expected <sample every=\"...\"> for actions at "
                 "equal intervals from the start, or a condition that becomes true later",
                 event->text, at_start ? "is true at the start, and does not become true later" : "is never true");
}

/* Returns bounds of an expression. mod(a, b) lies between 0 and b. */
static struct Bounds bounds_with_remainders(const struct Model *model, Node expression) {
  const struct Switches *switches = &model->switches;
  struct KnownBounds *known = allocate(switches->remainder_count, sizeof *known);
  for (size_t i = 0; i < switches->remainder_count; i++) {
    struct Bounds divisor = bounds_of(model, switches->remainders[i].divisor, NULL, 0);
    known[i] = (struct KnownBounds){switches->remainders[i].node, {fmin(divisor.low, 0.0), fmax(divisor.high, 0.0)}};
  }
  return bounds_of(model, expression, known, switches->remainder_count);
}

/* True for mod(a, b), and for a number times it, which has one sign for any b. */
static bool is_remainder(const struct Model *model, Node expression) {
  Node base;
  bool is_remainder = false;
  coefficient_of(model->graph, expression, &base);
  for (size_t i = 0; i < model->switches.remainder_count; i++)
    is_remainder |= model->switches.remainders[i].node == base;
  return is_remainder;
}

/* Warns of an expression that does not change its sign. */
static void warn_of_sign(const struct Reader *reader, const struct Event *event, bool is_of_time) {
  struct Bounds bounds = bounds_with_remainders(reader->model, event->expression);
  bool may_pass = bounds.low < 0.0 && bounds.high > 0.0;
  if (may_pass && !is_remainder(reader->model, event->expression)) return;
  report_warning(reader->diagnostics, event->line,
                 "the event never happens: when=\"%s\" %s, so that it does not pass 0; expected %s", event->text,
                 may_pass           ? "keeps its sign"
                 : bounds.low < 0.0 ? "is never above 0"
                                    : "is never below 0",
                 is_of_time ? "<sample every=\"...\"> for what happens periodically"
                            : "an expression that changes its sign, or a condition such as x > 1");
}

/* Warns of a condition that has one outcome for all values. False if there is no warning. */
static bool warn_of_outcome(const struct Reader *reader, const struct Event *event) {
  enum Outcome outcome = outcome_of(reader->model, event->condition);
  if (outcome == OUTCOME_VARIES) return false;
  report_warning(reader->diagnostics, event->line,
                 "the event never happens: when=\"%s\" is true at %s; expected a condition that becomes true",
                 event->text, outcome == OUTCOME_ALWAYS ? "all times" : "no time");
  return true;
}

void warn_of_events(const struct Reader *reader) {
  struct Model model = *reader->model; /* with a copy of the graph, which derivatives change */
  if (model.switches.event_count > 0) model.graph = graph_copy(model.graph);
  for (size_t i = 0; i < model.switches.event_count; i++) {
    const struct Event *event = &model.switches.events[i];
    if (event->passage == PASSAGE_HOLDS && !warn_of_outcome(reader, event)) warn_of_condition(reader, &model, event);
    if (event->expression == ZERO) continue;
    cone_collect(model.graph->cone, model.graph, &event->expression, 1);
    bool is_of_time = is_alone(&model, event);
    if (is_of_time && count_switches(&model) == 0) warn_of_event(reader, &model, event);
    else warn_of_sign(reader, event, is_of_time);
  }
}
