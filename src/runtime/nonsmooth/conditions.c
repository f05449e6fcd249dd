/*
 * Triggers of <event> and <sample> elements. condition[i] of the resolution is the value of an event's condition
 * before the last change. It is positive if a condition was true; of an expression it is the last nonzero sign. An
 * event happens if its condition becomes positive, or if the sign of its expression changes in its direction. All
 * events of a round happen with the values before it, so that their order has no effect. Two that assign the same
 * variable are an error.
 */
#include "nonsmooth/conditions.h"

#include "evaluation/evaluate.h"
#include "instance/time_laws.h"

/* True if the event waits for zero crossings of an expression. */
static bool has_last_sign(const struct EventMetadata *event) {
  return event->passage != PASSAGE_HOLDS && event->passage != PASSAGE_SAMPLES;
}

/* Assigns the values of an event. They are in value[], which was evaluated before the first assignment of the round. */
static void assign(struct Resolution *resolution, const struct EventMetadata *event) {
  const struct SwitchTable *switches = resolution->switches;
  const double *value = resolution->value + assignment_slot(switches, 0);
  for (size_t i = event->first_assignment; i < event->first_assignment + event->assignment_count; i++) {
    const struct AssignmentMetadata *metadata = &switches->assignments[i];
    if (metadata->kind == VARIABLE_MODE) {
      resolution_set_mode(resolution, metadata->index, value[i]);
      resolution->set_mode = true;
    } else {
      resolution->state[metadata->index] = value[i];
      resolution->jumped = resolution->thrown = resolution->changed = true;
      resolution->moved |= metadata->index < lagrangian.coordinate_count;
    }
  }
}

/* Stores the conditions before events: all, or those that contacts decide. For expressions: the last nonzero sign. */
static void note_conditions(struct Resolution *resolution, bool all) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->event_count; i++) {
    const struct EventMetadata *event = &switches->events[i];
    double condition = resolution->value[condition_slot(switches, i)];
    bool stays = has_last_sign(event) && condition == 0.0;
    if (!stays && (all || event->is_of_contacts)) resolution->condition[i] = condition;
  }
}

void conditions_begin(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->event_count; i++) {
    const struct EventMetadata *event = &switches->events[i];
    double condition = resolution->value[condition_slot(switches, i)];
    bool had_sign = has_last_sign(event) && mode_of(resolution, event->last_sign) != 0.0;
    resolution->condition[i] = had_sign ? mode_of(resolution, event->last_sign) : condition;
  }
}

/* Stores the last nonzero signs of expressions. A sign stays if an event turned its expression back before 0. */
static void keep_last_signs(const struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->event_count; i++) {
    const struct EventMetadata *event = &switches->events[i];
    double sign = resolution->value[condition_slot(switches, i)];
    if (has_last_sign(event) && sign != 0.0) resolution->instance->parameter[event->last_sign] = sign;
  }
}

/* True if the event happens. There is no crossing without a previous nonzero sign. */
static bool happens(const struct Resolution *resolution, size_t event) {
  const struct EventMetadata *metadata = &resolution->switches->events[event];
  double condition = resolution->value[condition_slot(resolution->switches, event)],
         before = resolution->condition[event];
  if (metadata->passage == PASSAGE_SAMPLES) return condition > 0.0;
  if (metadata->passage == PASSAGE_HOLDS) return condition > 0.0 && !(before > 0.0);
  bool rises = condition > 0.0 && before < 0.0, falls = condition < 0.0 && before > 0.0;
  return (rises && metadata->passage != PASSAGE_FALLS) || (falls && metadata->passage != PASSAGE_RISES);
}

/* Returns an assignment that two events share; NULL for none. */
static const struct AssignmentMetadata *rival_assignment(const struct SwitchTable *switches,
                                                         const struct EventMetadata *one,
                                                         const struct EventMetadata *other) {
  for (size_t i = one->first_assignment; i < one->first_assignment + one->assignment_count; i++)
    for (size_t j = other->first_assignment; j < other->first_assignment + other->assignment_count; j++) {
      const struct AssignmentMetadata *first = &switches->assignments[i], *second = &switches->assignments[j];
      if (first->kind == second->kind && first->index == second->index) return first;
    }
  return NULL;
}

static const char *attribute_of(const struct EventMetadata *event) {
  return event->passage == PASSAGE_SAMPLES ? "every" : "when";
}

/* Logs an event that happens at the same time and sets the same variable; true if there is one. */
static bool find_rivals(const struct Resolution *resolution, size_t event) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t k = 0; k < event; k++) {
    if (!happens(resolution, k)) continue;
    const struct AssignmentMetadata *rival = rival_assignment(switches, &switches->events[k], &switches->events[event]);
    if (rival == NULL) continue;
    log_message(resolution->instance, resolution_status(resolution),
                "time %g: the events number %zu, %s=\"%s\", and number %zu, %s=\"%s\", happen at once and both set "
                "'%s'; expected one event, or conditions that keep them apart",
                resolution->time, k + 1, attribute_of(&switches->events[k]), switches->events[k].when, event + 1,
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
static bool is_at_zero(const struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  bool is_located = resolution->occasion == AT_EVENT && resolution->indicator < switches->branch_count;
  return is_located && switches->branches[resolution->indicator].is_last_sign && !resolution->moved;
}

/*
 * Clears the previous signs of events in both directions that happened at a located zero. If the event turns the motion
 * back, the expression returns from 0, which is no second crossing.
 */
static void begin_at_zero(struct Resolution *resolution) {
  for (size_t i = 0; i < resolution->switches->event_count; i++)
    if (resolution->happened[i] != 0.0 && resolution->switches->events[i].passage == PASSAGE_BOTH)
      resolution->condition[i] = 0.0;
}

/* Logs a sample whose period is not positive; true if there is one. */
static bool find_endless_sample(const struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->sample_count; i++) {
    double period = resolution->value[sample_slot(switches, i, SAMPLE_EVERY)], time = resolution->time;
    double offset = resolution->value[sample_slot(switches, i, SAMPLE_OFFSET)];
    if (is_period(period, offset, time)) continue;
    log_message(resolution->instance, resolution_status(resolution),
                "time %g: a <sample> has every=\"%s\", which is %g s, and its offset is %g s; expected a period above "
                "0 and above the resolution of time",
                time, switches->events[switches->samples[i].event].when, period, offset);
    return true;
  }
  return false;
}

const char *conditions_happen(struct Resolution *resolution, bool *again) {
  const struct SwitchTable *switches = resolution->switches;
  *again = false;
  if (find_endless_sample(resolution)) return "the period of a <sample> is not valid";
  /* Conditions that contacts and frictions fulfil from the start on have not just become true. */
  if (resolution->occasion == AT_START && !resolution->has_started) note_conditions(resolution, false);
  resolution->has_started = true;
  bool at_zero = is_at_zero(resolution);
  for (size_t i = 0; i < switches->event_count; i++) {
    resolution->happened[i] = happens(resolution, i) ? 1.0 : 0.0;
    if (!happens(resolution, i)) continue;
    if (find_rivals(resolution, i)) return "two events contradict each other";
    assign(resolution, &switches->events[i]);
    *again = true;
  }
  note_conditions(resolution, true);
  if (!*again) keep_last_signs(resolution);
  if (at_zero) begin_at_zero(resolution);
  return NULL;
}
