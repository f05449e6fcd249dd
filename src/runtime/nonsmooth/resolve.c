/*
 * Event resolution: consistent modes, velocities and state after an event. Several mechanisms may act at once: impacts
 * and contacts that close or open, pieces of functions, frictions that stick or slip, and <event> elements. Each round
 * evaluates everything and tries the mechanisms in the order of actions[], up to the first that changes something. The
 * rounds end when none does: then all modes agree with the state. A mode that keeps switching is an error of its own,
 * and so are more than ROUND_LIMIT rounds. A round costs a few evaluations of the accelerations, which also bound their
 * rounding errors.
 *
 * A kink of forces needs no rounds (branches_pass_kink()).
 *
 * Then velocities are projected onto the constraints, and the result is checked. Energies and positions must not
 * jump where no event sets them, and contacts and frictions must obey their laws.
 */
#include "nonsmooth/resolve.h"

#include <string.h>

#include "evaluation/evaluate.h"
#include "evaluation/services.h"
#include "instance/active_constraints.h"
#include "nonsmooth/branches.h"
#include "nonsmooth/conditions.h"
#include "nonsmooth/continuity.h"

/* Rounds after which an event resolution fails. Impacts alone take up to IMPACT_LIMIT rounds (impact_sequence.c). */
enum { ROUND_LIMIT = 2000 };

static const char no_accelerations[] = "the accelerations do not exist after an event",
                  no_first_accelerations[] = "the accelerations do not exist";

static const char *act_by_contacts(struct Resolution *resolution, bool *again) {
  const struct ContactLaws *laws = resolution->switches->contact_laws;
  return laws != NULL ? laws->act(resolution, again) : NULL;
}

/* Notes that a friction has switched, to whose event an importer may have come late. */
static void note_lag(struct Resolution *resolution, bool switched) {
  resolution->lags |= switched && resolution->occasion != AT_START;
}

/* The forces of constraints that contradict others say nothing about contacts, and of frictions these give way. */
static const char *slide_unheld(struct Resolution *resolution, bool *again) {
  const struct FrictionLaws *laws = resolution->switches->friction_laws;
  *again = laws != NULL && laws->slide_unheld(resolution);
  note_lag(resolution, *again);
  return NULL;
}

static const char *open_pulling_contacts(struct Resolution *resolution, bool *again) {
  const struct ContactLaws *laws = resolution->switches->contact_laws;
  *again = laws != NULL && laws->open_pulling(resolution);
  return NULL;
}

static const char *switch_pieces(struct Resolution *resolution, bool *again) {
  return branches_switch(resolution, false, again);
}

static const char *act_by_frictions(struct Resolution *resolution, bool *again) {
  const struct FrictionLaws *laws = resolution->switches->friction_laws;
  const char *problem = laws != NULL ? laws->act(resolution, again) : NULL;
  note_lag(resolution, *again);
  return problem;
}

static const char *resolve_contact_forces(struct Resolution *resolution, bool *again) {
  const struct ContactLaws *laws = resolution->switches->contact_laws;
  return laws != NULL ? laws->resolve_forces(resolution, again) : NULL;
}

static const char *let_touching_share(struct Resolution *resolution, bool *again) {
  const struct ContactLaws *laws = resolution->switches->contact_laws;
  *again = laws != NULL && laws->share_load(resolution);
  return NULL;
}

static const char *report_friction_modes(struct Resolution *resolution, bool *again) {
  const struct FrictionLaws *laws = resolution->switches->friction_laws;
  return laws == NULL || laws->report(resolution, again) ? NULL : no_accelerations;
}

/* Finds which velocities rest, before pieces switch by them; sets *again if any stops or leaves rest. */
static const char *find_resting_velocities(struct Resolution *resolution, bool *again) {
  const struct SwitchTable *switches = resolution->switches;
  if (switches->find_resting == NULL) return NULL;
  switches->find_resting(resolution);
  for (size_t i = 0; i < switches->resting_count; i++) {
    size_t mode = switches->resting[i].mode;
    bool rests = resolution->moves[i] == VELOCITY_RESTS, rested = mode_of(resolution, mode) == VELOCITY_RESTS;
    /* No function distinguishes velocities that accelerate from others that move. */
    resolution->instance->parameter[mode] = resolution->moves[i];
    if (rests == rested) continue;
    resolution_set_mode(resolution, mode, resolution->moves[i]);
    if (rests) resolution->has_rested = true;
    else resolution->has_left_rest = true;
    *again = true;
  }
  return NULL;
}

/* Sets velocities at rest to 0: projections leave rounding errors, and methods errors in prescribed motions. */
static void set_resting_velocities(const struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->resting_count && resolution->changed; i++) {
    const struct RestingMetadata *resting = &switches->resting[i];
    if (resting->kind != RESTING_SUM && mode_of(resolution, resting->mode) == VELOCITY_RESTS)
      resolution->state[lagrangian.coordinate_count + resting->index] = 0.0;
  }
}

/*
 * Switches the signs of the expressions of events. An importer comes to an event late: velocities that stick from it on
 * are brought to rest first.
 */
static const char *switch_last_signs(struct Resolution *resolution, bool *again) {
  if (!resolution->switches->has_last_signs) return NULL;
  if (!resolution->lags) return branches_switch(resolution, true, again);
  resolution->lags = false;
  *again = true;
  return resolution_project_velocities(resolution) ? NULL : constraints_not_kept;
}

/* The mechanisms that a round tries in turn, up to the first that changes something. */
static const char *(*const actions[])(struct Resolution *resolution, bool *again) = {
    act_by_contacts,       slide_unheld,      open_pulling_contacts,  find_resting_velocities,
    switch_pieces,         act_by_frictions,  resolve_contact_forces, let_touching_share,
    report_friction_modes, switch_last_signs, conditions_happen};
enum { ACTION_COUNT = sizeof actions / sizeof *actions };

/* Makes one round; sets *again if it changed something. */
static const char *resolve_once(struct Resolution *resolution, bool *again) {
  const char *problem = NULL;
  *again = false;
  for (int i = 0; i < ACTION_COUNT && problem == NULL && !*again; i++) problem = actions[i](resolution, again);
  return problem;
}

static const char *resolve_in_rounds(struct Resolution *resolution) {
  const char *problem = NULL;
  bool again = true;
  for (int round = 0; problem == NULL && again; round++) {
    if (round == ROUND_LIMIT) return "events follow each other without end (Zeno behaviour)";
    if (!resolution_evaluate(resolution)) {
      if (round == 0 || !resolution_ends_slip(resolution)) return no_accelerations;
      continue;
    }
    if (round == 0) conditions_begin(resolution);
    problem = resolve_once(resolution, &again);
  }
  return problem;
}

/* Sets the modes to the signs of the start values, or projects the state that the solver has left. */
static const char *begin_resolution(struct Resolution *resolution) {
  const struct ContactLaws *laws = resolution->switches->contact_laws;
  if (resolution->occasion != AT_START) return continuity_begin(resolution);
  if (!branches_begin(resolution)) return no_first_accelerations;
  if (laws == NULL) return NULL;
  if (!laws->lift_start(resolution) || !branches_begin(resolution)) return constraints_not_kept;
  return laws->check_gaps(resolution);
}

/* Projects velocities that have jumped onto the constraints. */
static const char *push(struct Resolution *resolution) {
  bool has_to_keep = resolution->jumped && lagrangian.constraints.projection != NULL;
  return has_to_keep && !resolution_project_velocities(resolution) ? constraints_not_kept : NULL;
}

/* Checks contacts and frictions after an event. Returns NULL, or the violated law. */
static const char *check_laws(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  const char *problem = NULL;
  if (switches->contact_laws != NULL && (resolution->moved || may_change_gaps(resolution)))
    problem = switches->contact_laws->check_gaps(resolution);
  if (problem == NULL && switches->friction_laws != NULL) problem = switches->friction_laws->check(resolution);
  return problem;
}

/*
 * Projects the state for the final modes: the last forces may be those of modes that were tried. An importer that
 * integrates projects its state itself, in event mode.
 */
static const char *keep_on_constraints(struct Resolution *resolution) {
  const struct FrictionLaws *laws = resolution->switches->friction_laws;
  bool has_to_keep = resolution->occasion != AT_START && resolution->occasion != IN_EXCHANGE;
  if (!resolution->changed || !has_to_keep) return NULL;
  if (evaluate_prepare(resolution->instance) != STATUS_DONE) return constraints_not_kept;
  const char *problem = solver_project(resolution->instance, resolution->time, resolution->state);
  bool may_stop = problem == NULL && laws != NULL && laws->slip_where_stopped != NULL;
  return may_stop && !laws->slip_where_stopped(resolution) ? no_accelerations : problem;
}

bool resolve_explain(struct Instance *instance, double time, double *state) {
  const struct SlidingLaws *laws = lagrangian.switches->sliding_laws;
  if (laws == NULL || evaluate_prepare(instance) != STATUS_DONE) return false;
  struct Resolution resolution = resolution_at(instance, time, state, AT_CHANGE);
  struct Point point = solver_point(instance, time, state);
  size_t rows = lagrangian.coordinate_count + lagrangian.constraints.count;
  /* Near a jam, forces may be too large to be determined: evaluate without them. */
  memset(resolution.acceleration, 0, rows * sizeof *resolution.acceleration);
  memset(resolution.error_bound, 0, resolution_value_count(lagrangian.switches) * sizeof *resolution.error_bound);
  lagrangian.switches->switching_values(&point, resolution.acceleration, resolution.value);
  return laws->explain(&resolution);
}

/* Logs a friction that jams a contact or a constraint, as where the equations become singular. False if none does. */
static bool explain_jam(struct Resolution *resolution) {
  struct Instance *instance = resolution->instance;
  const struct FrictionLaws *laws = resolution->switches->friction_laws;
  int singular = instance->singular;
  bool behind_start = resolution->occasion != AT_START;
  bool jams = (behind_start && resolve_explain(instance, resolution->time, resolution->state)) ||
              (singular != 0 && laws != NULL && laws->explain_jam(resolution, resolution->switches->branch_count));
  instance->singular = jams ? 0 : singular;
  return jams;
}

/* Logs that accelerations are missing for the frictions. A singular mass matrix is reported as such. */
static void report_missing_for_frictions(const struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  if (switches->friction_count > 0 && resolution->instance->singular == 0)
    switches->friction_laws->report_missing(resolution, "accelerations");
}

static void log_switch(const struct Resolution *resolution, const char *name) {
  log_message(resolution->instance, STATUS_DONE, "time %.17g: '%s' switches", resolution->time, name);
}

/* Logs the name of each contact that switched or was struck, and of each friction that switched. */
static void log_switches(const struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->contact_count; i++) {
    size_t mode = switches->contacts[i].mode;
    bool switches_mode = mode_of(resolution, mode) != first_mode_of(resolution, mode);
    if (switches_mode || resolution->struck[i] != 0.0) log_switch(resolution, switches->contacts[i].name);
  }
  for (size_t i = 0; i < switches->friction_count; i++) {
    double mode = mode_of(resolution, switches->frictions[i].mode);
    double first = first_mode_of(resolution, switches->frictions[i].mode);
    bool sticks_or_slides = (mode == 0.0) != (first == 0.0);
    bool reverses = mode != first && !is_in_plane(switches, i);
    if (sticks_or_slides || reverses) log_switch(resolution, switches->frictions[i].name);
  }
}

/* True if the open contact whose gap has reached 0 lifts: its gap neither closes nor is about to. */
static bool lifts(const struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  size_t contact = resolution->indicator - contact_indicator(switches, 0), slot = contact_slot(switches, contact, 0);
  if (resolution->occasion != AT_EVENT || contact >= switches->contact_count) return false;
  const double *value = resolution->value + slot, *error_bound = resolution->error_bound + slot;
  return !contact_holds(resolution->instance, contact) && value[CONTACT_ACCELERATION] > 0.0 &&
         value[CONTACT_RATE] >= -error_bound[CONTACT_RATE];
}

/* Counts an event that branches_pass_kink() has passed. */
static void count_kink(struct Instance *instance, bool *changed) {
  instance->fmu_state->statistics[STATISTIC_EVENTS]++;
  instance->lifts = false;
  *changed = true;
}

/* Notes that an indicator leaves 0, by its event. */
static void note_departure(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  size_t branch = resolution->indicator;
  resolution->is_departure = resolution->occasion == AT_EVENT && branch < switches->branch_count &&
                             mode_of(resolution, switches->branches[branch].mode) == 0.0;
  resolution->is_beside_departure = resolution->time == resolution->instance->departure_time;
  if (resolution->is_departure) resolution->instance->departure_time = resolution->time;
}

/* Resolves the event, and sets *changed. Returns NULL, or the reason why the motion cannot continue. */
static const char *resolve_event(struct Resolution *resolution, bool *changed) {
  struct Instance *instance = resolution->instance;
  note_departure(resolution);
  memcpy(resolution->first_modes, modes_of(instance), resolution->switches->mode_count * sizeof(double));
  if (branches_pass_kink(resolution)) {
    count_kink(instance, changed);
    return NULL;
  }
  const char *problem = begin_resolution(resolution);
  if (problem == NULL) problem = resolve_in_rounds(resolution);
  resolution->changed = resolution_has_changed(resolution);
  bool is_missing = problem == no_accelerations || problem == no_first_accelerations;
  bool is_explained = is_missing && explain_jam(resolution);
  if (problem == no_accelerations && !is_explained) report_missing_for_frictions(resolution);
  if (problem == NULL) problem = branches_check(resolution);
  if (problem == NULL) problem = push(resolution);
  if (problem == NULL) problem = continuity_check(resolution);
  if (problem == NULL) problem = check_laws(resolution);
  if (problem == NULL) problem = keep_on_constraints(resolution);
  if (problem == NULL) problem = continuity_check_corner(resolution);
  if (problem == NULL) set_resting_velocities(resolution);
  if (resolution->changed && resolution->occasion != AT_START) {
    instance->fmu_state->statistics[STATISTIC_EVENTS]++;
    if (problem == NULL) log_switches(resolution);
  }
  instance->lifts = problem == NULL && lifts(resolution);
  *changed = resolution->changed;
  return problem;
}

const char *resolve(struct Instance *instance, double time, double *state, enum Occasion occasion, size_t indicator,
                    bool *changed) {
  struct Resolution resolution = resolution_at(instance, time, state, occasion);
  resolution.indicator = indicator;
  return resolve_event(&resolution, changed);
}

/* True if another constraint of a contact or friction is active than at the start of the event. */
static bool other_constraints_are_active(const struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  bool other = false;
  for (size_t i = 0; i < switches->contact_count; i++)
    other |= contact_holds(resolution->instance, i) != (first_mode_of(resolution, switches->contacts[i].mode) > 0.0);
  for (size_t i = 0; i < switches->friction_count; i++)
    other |= friction_holds(resolution->instance, i) != (first_mode_of(resolution, switches->frictions[i].mode) == 0.0);
  return other;
}

bool resolve_or_restore(struct Instance *instance, double time, double *state, bool *switches) {
  struct Resolution resolution = resolution_at(instance, time, state, AT_CHANGE);
  struct DeferredLog deferred;
  bool changed;
  log_defer(instance, &deferred);
  bool agrees = resolve_event(&resolution, &changed) == NULL;
  log_release(instance, &deferred);
  *switches = agrees && other_constraints_are_active(&resolution);
  if (agrees) log_write_deferred(instance, &deferred);
  else {
    memcpy(modes_of(instance), resolution.first_modes, resolution.switches->mode_count * sizeof(double));
    instance->parameter_constants_are_stale = true;
  }
  return agrees;
}
