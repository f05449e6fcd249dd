/*
 * Event resolution: consistent modes, velocities and state after an event. Several mechanisms may act at once: impacts
 * and contacts that close or open, pieces of functions, frictions that stick or slip, and <event> elements. Each round
 * evaluates everything and tries the mechanisms in the order of actions[], up to the first that changes something. The
 * rounds end when none does: then all modes agree with the state. A mode that keeps switching is an error of its own,
 * and so are more than ROUND_LIMIT rounds. A round costs a few evaluations of the accelerations, which also bound their
 * rounding errors.
 *
 * Then velocities are projected onto the constraints, and the result is checked: energies and positions must not jump
 * where no event sets them, and contacts and frictions must obey their laws.
 */
#include "events/settle.h"

#include <string.h>

#include "evaluation/evaluate.h"
#include "evaluation/services.h"
#include "events/branches.h"
#include "events/conditions.h"
#include "events/continuity.h"

enum { ROUND_LIMIT = 2000 };

static const char no_accelerations[] = "the accelerations do not exist after an event",
                  no_first_accelerations[] = "the accelerations do not exist";

static const char *act_by_contacts(struct Settlement *settlement, bool *again) {
  const struct ContactLaws *laws = settlement->switches->contact_laws;
  return laws != NULL ? laws->act(settlement, again) : NULL;
}

static const char *switch_pieces(struct Settlement *settlement, bool *again) {
  return branches_switch(settlement, false, again);
}

static const char *act_by_frictions(struct Settlement *settlement, bool *again) {
  const struct FrictionLaws *laws = settlement->switches->friction_laws;
  const char *problem = laws != NULL ? laws->act(settlement, again) : NULL;
  settlement->lags |= *again && settlement->occasion != AT_START;
  return problem;
}

static const char *settle_contact_forces(struct Settlement *settlement, bool *again) {
  const struct ContactLaws *laws = settlement->switches->contact_laws;
  return laws != NULL ? laws->settle_forces(settlement, again) : NULL;
}

static const char *let_touching_share(struct Settlement *settlement, bool *again) {
  const struct ContactLaws *laws = settlement->switches->contact_laws;
  return laws != NULL ? laws->share_load(settlement, again) : NULL;
}

static const char *tell_friction_modes(struct Settlement *settlement, bool *again) {
  const struct FrictionLaws *laws = settlement->switches->friction_laws;
  return laws == NULL || laws->tell(settlement, again) ? NULL : no_accelerations;
}

/*
 * Switches the signs of the expressions of events. An importer comes to an event late: velocities that stick from it on
 * are brought to rest first.
 */
static const char *switch_sides(struct Settlement *settlement, bool *again) {
  if (!settlement->switches->has_sides) return NULL;
  if (!settlement->lags) return branches_switch(settlement, true, again);
  settlement->lags = false;
  *again = true;
  return settlement_push(settlement) ? NULL : constraints_not_kept;
}

/* The mechanisms that a round tries in turn, up to the first that changes something. */
static const char *(*const actions[])(struct Settlement *settlement, bool *again) = {
    act_by_contacts,    switch_pieces,       act_by_frictions, settle_contact_forces,
    let_touching_share, tell_friction_modes, switch_sides,     conditions_happen};
enum { ACTION_COUNT = sizeof actions / sizeof *actions };

/* Makes one round; sets *again if it changed something. */
static const char *settle_once(struct Settlement *settlement, bool *again) {
  const char *problem = NULL;
  *again = false;
  for (int i = 0; i < ACTION_COUNT && problem == NULL && !*again; i++) problem = actions[i](settlement, again);
  return problem;
}

static const char *settle_in_rounds(struct Settlement *settlement) {
  const char *problem = NULL;
  bool again = true;
  for (int round = 0; problem == NULL && again; round++) {
    if (round == ROUND_LIMIT) return "events follow each other without end (Zeno behaviour)";
    if (!settlement_evaluate(settlement)) return no_accelerations;
    if (round == 0) conditions_begin(settlement);
    problem = settle_once(settlement, &again);
  }
  return problem;
}

/* Sets the modes to the signs of the start values, or projects the state that the solver has left. */
static const char *begin_settlement(struct Settlement *settlement) {
  const struct ContactLaws *laws = settlement->switches->contact_laws;
  if (settlement->occasion != AT_START) return continuity_begin(settlement);
  if (!branches_begin(settlement)) return no_first_accelerations;
  if (laws == NULL) return NULL;
  if (!laws->lift_start(settlement) || !branches_begin(settlement)) return constraints_not_kept;
  return laws->check_gaps(settlement);
}

/* Projects velocities that have jumped onto the constraints. */
static const char *push(struct Settlement *settlement) {
  bool has_to_keep = settlement->jumped && lagrangian.constraints.projection != NULL;
  return has_to_keep && !settlement_push(settlement) ? constraints_not_kept : NULL;
}

/* Checks contacts and frictions after an event. Returns NULL, or the violated law. */
static const char *check_laws(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  const char *problem = NULL;
  if (switches->contact_laws != NULL && (settlement->moved || may_turn_gaps(settlement)))
    problem = switches->contact_laws->check_gaps(settlement);
  if (problem == NULL && switches->friction_laws != NULL) problem = switches->friction_laws->check(settlement);
  return problem;
}

/*
 * Projects the state for the final modes: the last forces may be those of modes that were tried. An importer that
 * integrates projects its state itself, in event mode.
 */
static const char *keep_on_constraints(const struct Settlement *settlement) {
  bool has_to_keep = settlement->occasion != AT_START && settlement->occasion != IN_EXCHANGE;
  if (!settlement->changed || !has_to_keep) return NULL;
  if (evaluate_prepare(settlement->instance) != STATUS_DONE) return constraints_not_kept;
  return solver_project(settlement->instance, settlement->time, settlement->state);
}

bool settle_explain(struct Instance *instance, double time, double *state) {
  const struct ContactLaws *laws = lagrangian.switches->contact_laws;
  if (laws == NULL || evaluate_prepare(instance) != STATUS_DONE) return false;
  struct Settlement settlement = settlement_at(instance, time, state, AT_CHANGE);
  struct Point point = solver_point(instance, time, state);
  size_t rows = lagrangian.coordinate_count + lagrangian.constraints.count;
  /* Near a jam, forces may be too large to be determined: evaluate without them. */
  memset(settlement.acceleration, 0, rows * sizeof *settlement.acceleration);
  memset(settlement.noise, 0, settlement_value_count(lagrangian.switches) * sizeof *settlement.noise);
  lagrangian.switches->switching_values(&point, settlement.acceleration, settlement.value);
  return laws->explain(&settlement);
}

/* Logs a friction that jams a contact or a constraint, as where the equations become singular. False if none does. */
static bool explain_jam(struct Settlement *settlement) {
  struct Instance *instance = settlement->instance;
  const struct FrictionLaws *laws = settlement->switches->friction_laws;
  int singular = instance->singular;
  bool behind_start = settlement->occasion != AT_START;
  bool jams = (behind_start && settle_explain(instance, settlement->time, settlement->state)) ||
              (singular != 0 && laws != NULL && laws->explain_jam(settlement, settlement->switches->branch_count));
  instance->singular = jams ? 0 : singular;
  return jams;
}

/* Logs that accelerations are missing for the frictions. A singular mass matrix is reported as such. */
static void blame_frictions(const struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  if (switches->friction_count > 0 && settlement->instance->singular == 0)
    switches->friction_laws->blame(settlement, "accelerations");
}

const char *settle(struct Instance *instance, double time, double *state, enum Occasion occasion, size_t indicator,
                   bool *changed) {
  struct Settlement settlement = settlement_at(instance, time, state, occasion);
  settlement.indicator = indicator;
  const char *problem = begin_settlement(&settlement);
  if (problem == NULL) problem = settle_in_rounds(&settlement);
  bool lacks = problem == no_accelerations || problem == no_first_accelerations;
  bool is_explained = lacks && explain_jam(&settlement);
  if (problem == no_accelerations && !is_explained) blame_frictions(&settlement);
  if (problem == NULL) problem = branches_check(&settlement);
  if (problem == NULL) problem = push(&settlement);
  if (problem == NULL) problem = continuity_check(&settlement);
  if (problem == NULL) problem = check_laws(&settlement);
  if (problem == NULL) problem = keep_on_constraints(&settlement);
  if (problem == NULL) problem = continuity_check_corner(&settlement);
  if (settlement.changed && occasion != AT_START) instance->situation->statistics[STATISTIC_EVENTS]++;
  *changed = settlement.changed;
  return problem;
}
