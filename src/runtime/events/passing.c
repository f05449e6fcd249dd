/*
 * Events in a communication step. After each solver step, events_pass() searches it for the first event, interval
 * by interval (search_interval.c, search.c). The first interval is a little longer than the time between the last
 * two events, and each next one is twice as long. A solver step may reach far beyond the next event. The state at
 * the event comes from the dense output. resolve() finds the modes and the state after it, and the solver restarts
 * there.
 *
 * Three cases have no next event. If events accumulate at a point (Zeno behaviour), there are EVENT_LIMIT of them within
 * rounding, and one more for each indicator. If zeros cannot be separated, the solver restarts with steps shorter
 * by NEARER, at most NEARER_LIMIT times in a row. If intervals may hide something however short they are, there are
 * UNSURE_LIMIT of them. Time steps then pass the events of several contacts (time_steps.c). Else the motion stops.
 * So every communication step ends.
 */
#include "events/passing.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "evaluation/services.h"
#include "nonsmooth/continuity.h"
#include "detection/indicators.h"
#include "detection/search.h"
#include "nonsmooth/resolve.h"
#include "nonsmooth/resolution.h"
#include "detection/search_interval.h"
#include "instance/time_laws.h"

/* Consecutive events within rounding after which the motion stops, beyond one of each indicator. */
enum { EVENT_LIMIT = 30 };
/*
 * Events of one friction in a plane, more than of all others, while it does not slide. In slow steps, time steps pass
 * more.
 */
enum { CREEPING_LIMIT = 20 };
/* Length of the name of an indicator in messages. */
enum { NAME_SIZE = 200 };
/* Search intervals in a communication step that may hide a zero, after which the motion stops. */
enum { UNSURE_LIMIT = 1000 };

/* Divisor of the solver's step if events are too close together, and limit of such divisions in a row. */
enum { NEARER = 64, NEARER_LIMIT = 8 };

/*
 * Limits of a search beyond the communication step: in communication steps, and relative to the part of the solver's
 * step before the search. The last one is the fraction of the time to an event up to which the result is kept. The
 * event itself is located in its own communication step.
 */
static const double further_steps = 16.0, further_share = 2.0, share_before_event = 0.999;

/*
 * Length of the first interval, relative to the time between the last two events, and of each further one, relative to
 * the one before. Behind an interval that was too long, further ones grow by the former. Each costs nine evaluations of
 * all indicators.
 */
static const double look_ahead_share = 1.25, look_ahead_growth = 8.0;

/* The part of the rest of a communication step that time steps pass, if its events would take too much work. */
static const double stepped_share = 0.5;

static const char gathering[] = "events accumulate (Zeno behaviour)";
static const char bounces[] =
    "events accumulate (Zeno behaviour), as bounces by an <event> do; a <contact> comes to rest";
static const char chatter[] = "a friction sticks and slides without end (Zeno behaviour)";
static const char flutter[] = "a contact opens and closes without end (Zeno behaviour)";
static const char too_close[] = "the events are too close together to be separated";
static const char no_modes[] = "the accelerations do not exist with these parameters";

/* Finds the modes at a time, and the values that depend on them. Returns NULL, or the reason for a failure. */
static const char *modes_at(struct Instance *instance, double time, double *state, enum Occasion occasion,
                            size_t indicator) {
  bool changed;
  const char *problem = resolve(instance, time, state, occasion, indicator, &changed);
  return problem == NULL && evaluate_prepare(instance) != STATUS_DONE ? no_modes : problem;
}

bool events_start(struct Instance *instance) {
  instance->modes_stay = true;
  const char *problem = modes_at(instance, instance->fmu_state->time, instance->state, AT_START, 0);
  instance->modes_stay = false;
  if (problem != NULL) reject_call(instance, "%s, at the start values", problem);
  return problem == NULL;
}

/* The caller reports a failed evaluation. */
bool events_part(struct Instance *instance, double time) {
  const struct ContactLaws *contacts = lagrangian.switches->contact_laws;
  const struct FrictionLaws *frictions = lagrangian.switches->friction_laws;
  if (contacts == NULL && frictions == NULL) return true;
  struct Resolution resolution = resolution_at(instance, time, instance->state, AT_CHANGE);
  if (!resolution_evaluate(&resolution)) return true;
  if (frictions != NULL) frictions->release(&resolution);
  return contacts == NULL || contacts->part(&resolution);
}

bool events_resolve_change(struct Instance *instance, double time) {
  const char *problem = modes_at(instance, time, instance->state, AT_CHANGE, 0);
  if (problem != NULL) log_message(instance, STATUS_DISCARD, "time %.15g: %s", time, problem);
  return problem == NULL;
}

const char *events_update(struct Instance *instance) {
  struct FmuState *fmu_state = instance->fmu_state;
  bool changed;
  if (evaluate_prepare(instance) != STATUS_DONE) return no_modes;
  const struct TimeLaws *times = lagrangian.switches->time_laws;
  bool is_due = fmu_state->waiting_event == 0 && times != NULL && times->is_due(instance);
  /* Otherwise the modes agree already; the sign of an indicator that leaves 0 is known only from its event. */
  if (fmu_state->waiting_event == 0 && fmu_state->changed != CHANGED_VALUES && !is_due) return NULL;
  enum Occasion occasion = fmu_state->waiting_event > 0 ? AT_EVENT : AT_CHANGE;
  size_t indicator = occasion == AT_EVENT ? (size_t)fmu_state->waiting_event - 1 : 0;
  const char *problem = resolve(instance, fmu_state->time, instance->state, occasion, indicator, &changed);
  bool is_new = occasion == AT_EVENT || changed;
  if (is_new && fmu_state->changed == CHANGED_NOTHING) fmu_state->changed = CHANGED_BY_EVENT;
  fmu_state->waiting_event = 0;
  return problem;
}

/* Restarts the solver at a time, from the state in event_state. */
static const char *start_anew(struct Instance *instance, const struct CommunicationStep *step, double time) {
  const struct Solver *solver = lagrangian.solver;
  fmu_state_begin(instance->fmu_state, time);
  bool is_done = solver->restart == NULL || solver->restart(instance, instance->event_state, step);
  return is_done ? NULL : "out of memory for the solver";
}

/* Ends the communication step before an event, at which the importer asks for the modes. */
static const char *stop_at_event(struct Instance *instance, struct CommunicationStep *step, double time,
                                 size_t indicator) {
  instance->fmu_state->waiting_event = (int32_t)indicator + 1;
  step->end = time;
  step->length = time - step->start;
  return start_anew(instance, step, time);
}

/* Finds the next event up to an end. False if there is none. *time is NAN if it cannot be located. */
static bool find_next(struct Instance *instance, double end, struct EventProgress *progress, double *time,
                      size_t *indicator) {
  double look_ahead = look_ahead_share * progress->distance, growth = look_ahead_growth;
  while (progress->searched < end) {
    double near = look_ahead > 0.0 ? fmin(end, progress->searched + look_ahead) : end, requested = near;
    *time = NAN;
    struct IntervalSamples samples;
    bool is_sure = search_interval_shorten(instance, progress->searched, &near, &samples);
    if (!is_sure && ++progress->unsure > UNSURE_LIMIT) return true;
    if (search_for_event(instance, progress->searched, near, &samples, TO_ROUNDING, time, indicator)) return true;
    if (near < requested) growth = look_ahead_share;
    look_ahead = growth * (near - progress->searched);
    progress->searched = near;
    progress->close_events = 0;
  }
  progress->step_limit *= 2.0; /* no event is near: the solver's steps may grow again */
  progress->nearer = 0;
  return false;
}

/* True if the search may go beyond the communication step: the motion does not depend on inputs that end with it. */
static bool may_go_further(const struct Instance *instance, const struct CommunicationStep *step,
                           const struct EventProgress *progress) {
  const struct FmuState *fmu_state = instance->fmu_state;
  const struct Span *last = &fmu_state->last_step;
  bool is_new = last->start == step->start; /* as happens if values are set before each communication step */
  bool begins = progress->searched <= fmax(step->start, last->start) && progress->count == 0;
  return last->end > step->end && begins && !is_new && !fmu_state->input_derivatives_set;
}

/*
 * Searches a solver step beyond the present communication step, so that the next ones need no search. What prevents
 * evaluations there must not appear in messages.
 */
static void search_further(struct Instance *instance, const struct CommunicationStep *step,
                           struct EventProgress *progress) {
  struct FmuState *fmu_state = instance->fmu_state;
  double from = progress->searched, time;
  double further = fmax(further_steps * step->length, further_share * (from - fmu_state->last_step.start));
  double to = fmin(fmu_state->last_step.end, from + further);
  if (fmu_state->stop_time_defined) to = fmin(to, fmu_state->stop_time);
  if (!may_go_further(instance, step, progress) || !(to > step->end)) return;
  int singular = instance->singular;
  const char *limited_by = instance->limited_by;
  struct IntervalSamples samples;
  size_t indicator;
  if (search_interval_shorten(instance, from, &to, &samples)) {
    bool happens = search_for_event(instance, from, to, &samples, BEFORE_IT, &time, &indicator);
    if (!happens) progress->searched = to;
    else if (!isnan(time)) progress->searched = from + share_before_event * (time - from);
  }
  instance->singular = singular;
  instance->limited_by = limited_by;
}

/*
 * Restarts the solver with shorter steps at the last known time. Far from the start of a long step, the rounding of its
 * polynomial may hide tiny bounces. False if that does not help.
 */
static bool go_nearer(struct Instance *instance, const struct CommunicationStep *step, struct EventProgress *progress) {
  double step_limit = (instance->fmu_state->last_step.end - progress->searched) / NEARER;
  if (progress->unsure > UNSURE_LIMIT || ++progress->nearer > NEARER_LIMIT) return false;
  if (solver_step_vanishes(progress->searched, step_limit)) return false;
  if (!lagrangian.solver->interpolate(instance, progress->searched, instance->event_state)) return false;
  progress->step_limit = step_limit;
  return start_anew(instance, step, progress->searched) == NULL;
}

static bool is_of_contact(size_t indicator) {
  const struct SwitchTable *switches = lagrangian.switches;
  return indicator >= contact_indicator(switches, 0) && indicator < friction_indicator(switches, 0);
}

/* True for bounces of contacts, which come to rest by themselves; those that an <event> makes do not. */
static bool is_bounce(const struct Instance *instance, size_t indicator) {
  return is_of_contact(indicator) && !indicator_is_force(instance, indicator);
}

/*
 * Counts an event of a friction in a plane that sticks, creeps, or is about to slip. A majority vote finds the one of
 * most events. Where constraints determine no unique forces, those at rest may set a friction in motion, and those in
 * motion stop it (Zeno behaviour).
 */
static void count_creeping(const struct Instance *instance, size_t indicator, struct EventProgress *progress) {
  const struct SwitchTable *switches = lagrangian.switches;
  size_t friction = indicator - friction_indicator(switches, 0);
  if (indicator < friction_indicator(switches, 0) || !is_in_plane(switches, friction)) return;
  size_t plane = plane_of(switches, friction);
  bool slides = instance->parameter[switches->frictions[switches->planes[plane].along].mode] == PLANE_SLIDES;
  if (plane == progress->creeping) progress->creeping_events = slides ? 0 : progress->creeping_events + 1;
  else if (progress->creeping_events > 0) progress->creeping_events -= slides ? 0 : 1;
  else if (!slides) {
    progress->creeping = plane;
    progress->creeping_events = 1;
  }
}

/* Updates the progress of the step by an event. */
static void count_event(const struct Instance *instance, const struct CommunicationStep *step, double time,
                        size_t indicator, struct EventProgress *progress) {
  double since_last = progress->last > 0.0 ? time - (step->start + progress->last) : 0.0;
  bool is_at_rest = instance->was_at_zero && !is_bounce(instance, indicator);
  bool is_close = is_at_rest || solver_step_vanishes(time, time - progress->searched);
  bool is_close_to_last = is_at_rest && indicator == progress->indicator && progress->count > 0 &&
                          time - (step->start + progress->last) <= close_share * fabs(time);
  progress->close_events = is_close ? progress->close_events + 1 : 0;
  progress->close_events_at_rest = is_close_to_last ? progress->close_events_at_rest + 1 : 0;
  count_creeping(instance, indicator, progress);
  progress->distance = since_last;
  progress->last = time - step->start;
  progress->count++;
  progress->indicator = indicator;
  progress->searched = time;
}

/* Writes the name of an indicator's element. */
static void name_indicator(size_t indicator, char *text, size_t size) {
  const struct SwitchTable *switches = lagrangian.switches;
  size_t friction = indicator - friction_indicator(switches, 0);
  if (indicator < switches->branch_count)
    snprintf(text, size, "%s, line %ld of %s,", switches->branches[indicator].function,
             switches->branches[indicator].line, switches->branches[indicator].file);
  else if (is_of_contact(indicator))
    snprintf(text, size, "the contact '%s'", switches->contacts[indicator - contact_indicator(switches, 0)].name);
  else snprintf(text, size, "the friction '%s'", switches->frictions[friction].name);
}

/* Lets the solver start anew at a time with the modes that were found. False if that fails. */
static bool continue_from(struct Instance *instance, const struct CommunicationStep *step, double time,
                          struct EventProgress *progress) {
  if (evaluate_prepare(instance) != STATUS_DONE || start_anew(instance, step, time) != NULL) return false;
  progress->searched = time;
  return true;
}

/* Warns once of time steps. longest: in s; to which they may grow. */
static void report_steps(struct Instance *instance, double time, double longest, size_t last_indicator) {
  char name[NAME_SIZE];
  if (instance->reported_time_steps) return;
  instance->reported_time_steps = true;
  name_indicator(last_indicator, name, sizeof name);
  log_message(
      instance, STATUS_WARNING,
      "time %g: events of %s and others follow each other endlessly; time steps pass them, here and each further "
      "time; they are at most %.2g s long, and velocities have errors of what accelerations change in them",
      time, name, longest);
}

/* Passes events by time steps from a time on, from where the state is known. False if that fails. */
static bool step_over(struct Instance *instance, const struct CommunicationStep *step, double begin, double until,
                      struct EventProgress *progress) {
  double time = begin, longest = 0.0;
  if (lagrangian.switches->step_over_events == NULL) return false;
  if (!lagrangian.solver->interpolate(instance, begin, instance->event_state)) return false;
  if (!lagrangian.switches->step_over_events(instance, until, step->end, &progress->share, &time, &longest))
    return false;
  report_steps(instance, time, longest, progress->indicator);
  progress->close_events = progress->close_events_at_rest = 0;
  return continue_from(instance, step, time, progress);
}

/*
 * Finds the modes behind an event, whose state is in event_state. If there are none, time steps may pass the event; sets
 * *is_passed then. Returns NULL, or the reason for a failure, after logging it.
 */
static const char *modes_behind(struct Instance *instance, const struct CommunicationStep *step, double time,
                                size_t indicator, struct EventProgress *progress, bool *is_passed) {
  struct DeferredLog deferred;
  log_defer(instance, &deferred);
  const char *problem = modes_at(instance, time, instance->event_state, AT_EVENT, indicator);
  log_release(instance, &deferred);
  *is_passed = problem != NULL && step_over(instance, step, progress->searched, progress->searched, progress);
  if (!*is_passed) log_write_deferred(instance, &deferred);
  return *is_passed ? NULL : problem;
}

/*
 * Handles an event, whose state is in event_state, or ends the step before it. If a contact lifts whose gap falls below
 * 0, the errors of the method are larger than the gap. The next step of the solver is then shorter. Returns NULL, or
 * the reason why the motion ends there.
 */
static const char *pass_event(struct Instance *instance, struct CommunicationStep *step, double time, size_t indicator,
                              struct EventProgress *progress) {
  if (!are_finite(instance->event_state, lagrangian.state_count)) return "the motion grows without bound";
  if (instance->stops_at_events) return stop_at_event(instance, step, time, indicator);
  /* an importer in event mode without early return handles the events at the end of a step */
  if (instance->uses_event_mode && step->end - time <= rounding_of_time(step->end))
    return stop_at_event(instance, step, step->end, indicator);
  const struct SampleMetadata *sample = sample_of(lagrangian.switches, indicator);
  double moment = sample != NULL ? sample_time(instance, sample) : time; /* equal up to rounding, but without drift */
  bool is_gap = is_bounce(instance, indicator);
  bool is_passed = false;
  const char *problem = modes_behind(instance, step, moment, indicator, progress, &is_passed);
  if (is_passed) return NULL;
  if (is_gap && instance->lifts) progress->step_limit = (instance->fmu_state->last_step.end - time) / NEARER;
  const char *obstacle = start_anew(instance, step, time);
  return problem != NULL ? problem : obstacle;
}

/* Ends the step before an event that cannot be resolved. */
static const char *lose(struct Instance *instance, struct EventProgress *progress, size_t indicator) {
  char name[NAME_SIZE];
  progress->is_lost = true;
  if (progress->unsure > UNSURE_LIMIT) {
    const char *function = instance->limited_by;
    log_message(instance, STATUS_DISCARD,
                "time %.15g: the event indicators may hide events however short the steps are%s%s; expected a function "
                "that is less narrow, or a looser tolerance",
                progress->searched, function != NULL ? ", by " : "", function != NULL ? function : "");
    return too_close;
  }
  if (lagrangian.solver->interpolate(instance, progress->searched, instance->event_state) &&
      resolve_explain(instance, progress->searched, instance->event_state))
    return too_close;
  name_indicator(indicator, name, sizeof name);
  log_message(instance, STATUS_DISCARD,
              "time %.15g: %s crosses zero and returns faster than can be resolved; expected an expression that "
              "crosses zero less often",
              progress->searched, name);
  return too_close;
}

/* True, after logging it, if the events accumulate at a corner of a gap. */
static bool is_at_corner(struct Instance *instance, double time, size_t indicator) {
  if (indicator >= lagrangian.switches->branch_count) return false;
  if (!lagrangian.solver->interpolate(instance, time, instance->event_state)) return false;
  struct Resolution resolution = resolution_at(instance, time, instance->event_state, AT_EVENT);
  return continuity_explain_corner(&resolution, indicator);
}

/*
 * Ends the step at endless events. An importer in event mode would continue by one more event at each step, so for it
 * the step does not advance.
 */
static const char *report_zeno(struct Instance *instance, const struct CommunicationStep *step,
                               struct EventProgress *progress, size_t indicator) {
  char name[NAME_SIZE];
  const char *finer = lagrangian.solver->finer;
  progress->is_lost = true;
  if (instance->stops_at_events) progress->searched = step->start;
  if (is_at_corner(instance, progress->searched, indicator)) return touched_corner;
  name_indicator(indicator, name, sizeof name);
  if (indicator >= friction_indicator(lagrangian.switches, 0)) {
    log_message(instance, STATUS_DISCARD,
                "time %.15g: %s sticks and slides without end; expected another tolerance, or parameters for which it "
                "clearly sticks or slides",
                progress->searched, name);
    return chatter;
  }
  if (!is_of_contact(indicator)) {
    log_message(
        instance, STATUS_DISCARD,
        "time %.15g: %s switches without end (Zeno behaviour); expected a switch with hysteresis, or other parameters",
        progress->searched, name);
    return lagrangian.switches->event_count > 0 ? bounces : gathering;
  }
  log_message(instance, STATUS_DISCARD,
              "time %.15g: %s opens and closes without end, as when it opens without speed%s; expected %s",
              progress->searched, name, finer != NULL ? " and the errors of the method are larger than its gap" : "",
              finer != NULL ? finer : "a force or parameters for which it lifts or presses clearly");
  return flutter;
}

/* True if a sample is due at the end of the communication step, which rounding has made a little earlier. */
static bool ends_at_sample(const struct Instance *instance, double end, size_t *branch) {
  for (size_t i = 0; i < lagrangian.switches->sample_count; i++) {
    *branch = lagrangian.switches->samples[i].branch;
    if (fabs(sample_time(instance, &lagrangian.switches->samples[i]) - end) <= rounding_of_time(end)) return true;
  }
  return false;
}

/*
 * Sets event_state to the state at a time. Inside a step, a method with larger errors than rounding leaves the
 * constraints a little; the gap of a contact that opens must begin at 0. False if the state is not available.
 */
static bool take_event_state(struct Instance *instance, double time) {
  const struct Solver *solver = lagrangian.solver;
  if (!solver->interpolate(instance, time, instance->event_state)) return false;
  if (solver_error(instance) == 0.0 || solver_project(instance, time, instance->event_state) == NULL) return true;
  return solver->interpolate(instance, time, instance->event_state);
}

/* True if a friction begins to creep and stops endlessly, and its events take long. */
static bool creeps_on(const struct EventProgress *progress) {
  return progress->is_slow && progress->creeping_events > CREEPING_LIMIT;
}

/* True if there are more events within rounding than indicators that may all switch at one time. */
static bool is_endless(int close_events) {
  return close_events >= EVENT_LIMIT + (int)indicator_count(lagrangian.switches);
}

/* Times that modes are found from one time on by looking ahead: each may let one friction slide. */
enum { LOOK_LIMIT = 20 };

/* In communication steps: the shortest moment after which constraints may contradict each other clearly. */
static const double least_moment = 1e-4;

/*
 * True if other constraints are active at a later time, to which the state is extrapolated. If no modes are found there,
 * they stay.
 */
static bool change_modes(struct Instance *instance, double begin, double time) {
  bool switches;
  double *state = instance->event_state, *rate = state + lagrangian.state_count;
  if (!lagrangian.solver->interpolate(instance, begin, state)) return false;
  if (evaluate_prepare(instance) != STATUS_DONE || !solver_derivatives(instance, begin, state, rate)) return false;
  for (size_t i = 0; i < lagrangian.state_count; i++) state[i] += (time - begin) * rate[i];
  return resolve_or_restore(instance, time, state, &switches) && switches;
}

/* Takes the modes of a moment after a time, and the state there. False if none change. */
static bool pass_moment(struct Instance *instance, const struct CommunicationStep *step, double begin,
                        struct EventProgress *progress) {
  double time = begin + least_moment * (step->end - step->start);
  return time < step->end && change_modes(instance, begin, time) && continue_from(instance, step, time, progress);
}

/* Takes the modes of longer moments after a time, from that time on. False if none change, or after many times there. */
static bool take_later_modes(struct Instance *instance, const struct CommunicationStep *step, double begin,
                             struct EventProgress *progress) {
  bool changes = false;
  double longest = step->end - fmin(begin, step->start); /* the solver's step may begin before the communication step */
  progress->looks = begin > progress->looked_ahead ? 0 : progress->looks + 1;
  if (!(begin < step->end) || progress->looks == LOOK_LIMIT) return false;
  for (double moment = 10.0 * least_moment; moment <= 1.0 && !changes; moment *= 10.0)
    changes = change_modes(instance, begin, begin + moment * longest);
  if (!changes || !take_event_state(instance, begin)) return false;
  if (!continue_from(instance, step, begin, progress)) return false;
  progress->looked_ahead = begin;
  return true;
}

/*
 * Passes a time where constraints of modes begin to contradict others. An example is a part that frictions hold at rest,
 * and that begins to be driven without a jump of its acceleration. True if modes change; the solver then starts anew.
 */
static bool pass_contradiction(struct Instance *instance, const struct CommunicationStep *step, double begin,
                               struct EventProgress *progress) {
  return pass_moment(instance, step, begin, progress) || take_later_modes(instance, step, begin, progress);
}

/* Passes a contradiction that begins with the last step, which is then made again, or behind it. False if none does. */
static bool pass_contradictions(struct Instance *instance, const struct CommunicationStep *step,
                                struct EventProgress *progress) {
  const struct Span last = instance->fmu_state->last_step;
  if (instance->violated_constraint == 0) return false;
  return pass_contradiction(instance, step, last.start, progress) ||
         pass_contradiction(instance, step, last.end, progress);
}

/* True if the constraints of frictions contradict others in event_state. */
static bool contradicts(struct Instance *instance, double time) {
  double *state = instance->event_state + lagrangian.state_count;
  if (lagrangian.switches->friction_laws == NULL || lagrangian.constraints.projection == NULL) return false;
  memcpy(state, instance->event_state, lagrangian.state_count * sizeof *state);
  return solver_project(instance, time, state) != NULL;
}

/* Passes events that cannot be separated: by shorter steps of the solver, or by time steps. */
static const char *pass_inseparable(struct Instance *instance, const struct CommunicationStep *step, size_t indicator,
                                    struct EventProgress *progress) {
  double begin = progress->searched;
  if (go_nearer(instance, step, progress) || step_over(instance, step, begin, begin, progress)) return NULL;
  return lose(instance, progress, indicator);
}

const char *events_pass(struct Instance *instance, struct CommunicationStep *step, struct EventProgress *progress) {
  double end = fmin(instance->fmu_state->last_step.end, step->end), time;
  size_t indicator = 0;
  progress->searched = fmax(progress->searched, instance->fmu_state->searched);
  if (progress->searched < end) search_further(instance, step, progress);
  bool is_found = find_next(instance, end, progress, &time, &indicator);
  instance->fmu_state->searched = progress->searched;
  instance->fmu_state->close_events = 0;
  if (!is_found && end == step->end && ends_at_sample(instance, end, &indicator)) {
    is_found = true;
    time = end;
  }
  if (!is_found) return NULL;
  if (isnan(time)) return pass_inseparable(instance, step, indicator, progress);
  count_event(instance, step, time, indicator, progress);
  if (creeps_on(progress) && step_over(instance, step, time, time, progress)) return NULL;
  if (is_endless(progress->close_events) || progress->close_events_at_rest >= EVENT_LIMIT)
    return step_over(instance, step, time, time, progress) ? NULL : report_zeno(instance, step, progress, indicator);
  if (instance->stops_at_events) instance->fmu_state->close_events = progress->close_events;
  if (!take_event_state(instance, time)) return "the state is not available at the event";
  if (contradicts(instance, time) && pass_contradictions(instance, step, progress)) return NULL;
  return pass_event(instance, step, time, indicator, progress);
}

const char *events_pass_barrier(struct Instance *instance, struct CommunicationStep *step, const char *problem,
                                struct EventProgress *progress) {
  double last = instance->fmu_state->last_step.end, time;
  size_t indicator;
  if (is_endless(++progress->close_events)) return problem;
  if (pass_contradictions(instance, step, progress)) return NULL;
  if (!search_for_jump(instance, &time, instance->event_state, &indicator))
    return step_over(instance, step, last, last, progress) ? NULL : problem;
  if (time > step->end) time = step->end;
  progress->searched = time;
  return pass_event(instance, step, time, indicator, progress);
}

bool events_step_over(struct Instance *instance, const struct CommunicationStep *step, struct EventProgress *progress) {
  double begin = instance->fmu_state->last_step.end;
  return step_over(instance, step, begin, begin + stepped_share * (step->end - begin), progress);
}

const char *events_check(struct Instance *instance, double time) {
  const struct FrictionLaws *laws = lagrangian.switches->friction_laws;
  if (laws == NULL || !lagrangian.switches->friction_varies) return NULL;
  struct Resolution resolution = resolution_at(instance, time, instance->state, AT_EVENT);
  if (!resolution_values(&resolution, instance->state, resolution.value)) return NULL; /* the caller reports it */
  bool has_negative_force = false;
  for (size_t i = 0; i < lagrangian.switches->friction_count; i++)
    for (size_t part = FRICTION_FORCE; part <= FRICTION_FORCE_BACK; part += FRICTION_FORCE_BACK - FRICTION_FORCE)
      has_negative_force |= resolution.value[friction_slot(resolution.switches, i, part)] < 0.0;
  return has_negative_force && resolution_evaluate(&resolution) ? laws->check(&resolution) : NULL;
}

void events_explain(struct Instance *instance, const struct CommunicationStep *step,
                    const struct EventProgress *progress) {
  char name[NAME_SIZE];
  bool is_branch = progress->indicator < lagrangian.switches->branch_count;
  if (2 * progress->count < step->count) return;
  name_indicator(progress->indicator, name, sizeof name);
  log_message(instance, STATUS_DISCARD, "time %g: the step has %ld events, the last of %s%s",
              instance->fmu_state->last_step.end, progress->count, name,
              is_branch ? " as when the motion chatters about its zero" : "");
}

bool events_explain_stop(struct Instance *instance, double time) {
  const struct FrictionLaws *laws = lagrangian.switches->friction_laws;
  if (lagrangian.event_laws->explain_ball(instance, STATUS_DISCARD, time)) return true;
  if (resolve_explain(instance, time, instance->state)) return true;
  if (laws == NULL) return false;
  struct Resolution resolution = resolution_at(instance, time, instance->state, AT_CHANGE);
  return laws->explain_jam(&resolution, lagrangian.switches->branch_count);
}
