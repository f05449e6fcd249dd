#include "events/conditions.h"

#include "evaluation/evaluate.h"
#include "instance/time_laws.h"

/* True if the event waits for zero crossings of an expression. */
static bool has_side(const struct EventFacts *event) {
  return event->passage != PASSAGE_HOLDS && event->passage != PASSAGE_SAMPLES;
}

static void assign(struct Settlement *settlement, const struct EventFacts *event) {
  const struct SwitchTable *switches = settlement->switches;
  const double *value = settlement->value + assignment_place(switches, 0);
  for (size_t i = event->first_assignment; i < event->first_assignment + event->assignment_count; i++) {
    const struct AssignmentFacts *facts = &switches->assignments[i];
    if (facts->kind == VARIABLE_MODE) {
      settlement_set_mode(settlement, facts->index, value[i]);
      settlement->set_mode = true;
    } else {
      settlement->state[facts->index] = value[i];
      settlement->jumped = settlement->thrown = settlement->changed = true;
      settlement->moved |= facts->index < lagrangian.coordinate_count;
    }
  }
}

/* Stores the conditions before events: all, or those that contacts decide. For expressions: the last nonzero sign. */
static void note_conditions(struct Settlement *settlement, bool all) {
  const struct SwitchTable *switches = settlement->switches;
  for (size_t i = 0; i < switches->event_count; i++) {
    const struct EventFacts *event = &switches->events[i];
    double condition = settlement->value[condition_place(switches, i)];
    bool stays = has_side(event) && condition == 0.0;
    if (!stays && (all || event->is_of_contacts)) settlement->condition[i] = condition;
  }
}

void conditions_begin(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  for (size_t i = 0; i < switches->event_count; i++) {
    const struct EventFacts *event = &switches->events[i];
    double condition = settlement->value[condition_place(switches, i)];
    bool was_at_side = has_side(event) && mode_of(settlement, event->side) != 0.0;
    settlement->condition[i] = was_at_side ? mode_of(settlement, event->side) : condition;
  }
}

/* Stores the last nonzero signs of expressions. A sign stays if an event turned its expression back before 0. */
static void keep_sides(const struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  for (size_t i = 0; i < switches->event_count; i++) {
    const struct EventFacts *event = &switches->events[i];
    double sign = settlement->value[condition_place(switches, i)];
    if (has_side(event) && sign != 0.0) settlement->instance->parameter[event->side] = sign;
  }
}

/* True if the event happens. There is no crossing without a previous nonzero sign. */
static bool happens(const struct Settlement *settlement, size_t event) {
  const struct EventFacts *facts = &settlement->switches->events[event];
  double condition = settlement->value[condition_place(settlement->switches, event)],
         before = settlement->condition[event];
  if (facts->passage == PASSAGE_SAMPLES) return condition > 0.0;
  if (facts->passage == PASSAGE_HOLDS) return condition > 0.0 && !(before > 0.0);
  bool rises = condition > 0.0 && before < 0.0, falls = condition < 0.0 && before > 0.0;
  return (rises && facts->passage != PASSAGE_FALLS) || (falls && facts->passage != PASSAGE_RISES);
}

/* Returns an assignment that two events share; NULL for none. */
static const struct AssignmentFacts *rival_assignment(const struct SwitchTable *switches, const struct EventFacts *one,
                                                      const struct EventFacts *other) {
  for (size_t i = one->first_assignment; i < one->first_assignment + one->assignment_count; i++)
    for (size_t j = other->first_assignment; j < other->first_assignment + other->assignment_count; j++) {
      const struct AssignmentFacts *first = &switches->assignments[i], *second = &switches->assignments[j];
      if (first->kind == second->kind && first->index == second->index) return first;
    }
  return NULL;
}

static const char *attribute_of(const struct EventFacts *event) {
  return event->passage == PASSAGE_SAMPLES ? "every" : "when";
}

/* Logs an event that happens at the same time and sets the same variable; true if there is one. */
static bool find_rivals(const struct Settlement *settlement, size_t event) {
  const struct SwitchTable *switches = settlement->switches;
  for (size_t k = 0; k < event; k++) {
    if (!happens(settlement, k)) continue;
    const struct AssignmentFacts *rival = rival_assignment(switches, &switches->events[k], &switches->events[event]);
    if (rival == NULL) continue;
    log_message(settlement->instance, settlement_status(settlement),
                "time %g: the events number %zu, %s=\"%s\", and number %zu, %s=\"%s\", happen at once and both set "
                "'%s'; expected one event, or conditions that keep them apart",
                settlement->time, k + 1, attribute_of(&switches->events[k]), switches->events[k].when, event + 1,
                attribute_of(&switches->events[event]), switches->events[event].when,
                evaluate_name(rival->kind, rival->index));
    return true;
  }
  return false;
}

/*
 * True if the zero of an expression was located, and no coordinate has been set since. The expression is then at 0 and
 * not beyond it; if the event itself turns it back, that is no second crossing.
 */
static bool is_at_zero(const struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  bool is_located = settlement->occasion == AT_EVENT && settlement->indicator < switches->branch_count;
  return is_located && switches->branches[settlement->indicator].is_side && !settlement->moved;
}

/* Lets the next crossing of events that happened at 0 begin there. */
static void begin_at_zero(struct Settlement *settlement) {
  for (size_t i = 0; i < settlement->switches->event_count; i++)
    if (settlement->happened[i] != 0.0 && settlement->switches->events[i].passage == PASSAGE_BOTH)
      settlement->condition[i] = 0.0;
}

/* Logs a sample whose period is not positive; true if there is one. */
static bool find_endless_sample(const struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  for (size_t i = 0; i < switches->sample_count; i++) {
    double period = settlement->value[sample_place(switches, i, SAMPLE_EVERY)], time = settlement->time;
    double offset = settlement->value[sample_place(switches, i, SAMPLE_OFFSET)];
    if (is_period(period, offset, time)) continue;
    log_message(settlement->instance, settlement_status(settlement),
                "time %g: a <sample> has every=\"%s\", which is %g s, and its offset is %g s; expected a period above "
                "0 and above the resolution of time",
                time, switches->events[switches->samples[i].event].when, period, offset);
    return true;
  }
  return false;
}

const char *conditions_happen(struct Settlement *settlement, bool *again) {
  const struct SwitchTable *switches = settlement->switches;
  *again = false;
  if (find_endless_sample(settlement)) return "the period of a <sample> is not valid";
  /* Conditions that contacts and frictions fulfil from the start on have not just become true. */
  if (settlement->occasion == AT_START && !settlement->has_started) note_conditions(settlement, false);
  settlement->has_started = true;
  bool at_zero = is_at_zero(settlement);
  for (size_t i = 0; i < switches->event_count; i++) {
    settlement->happened[i] = happens(settlement, i) ? 1.0 : 0.0;
    if (!happens(settlement, i)) continue;
    if (find_rivals(settlement, i)) return "two events contradict each other";
    assign(settlement, &switches->events[i]);
    *again = true;
  }
  note_conditions(settlement, true);
  if (!*again) keep_sides(settlement);
  if (at_zero) begin_at_zero(settlement);
  return NULL;
}
