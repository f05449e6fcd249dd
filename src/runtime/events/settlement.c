#include "events/settlement.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "evaluation/services.h"
#include "events/indicators.h"
#include "events/search.h"

size_t settlement_value_count(const struct SwitchTable *switches) {
  return sample_place(switches, switches->sample_count, 0);
}

static size_t rows_of_matrix(void) {
  return lagrangian.coordinate_count + lagrangian.constraints.count;
}

/* Assigns the parts of the workspace, and returns its size; with work NULL the size alone. */
static size_t lay_out_settlement(struct Settlement *settlement, double *work) {
  const struct SwitchTable *switches = lagrangian.switches;
  size_t values = settlement_value_count(switches), indicators = indicator_count(switches);
  const struct {
    double **place;
    size_t count;
  } parts[] = {
      /* initially 0 */
      {&settlement->largest, values},
      {&settlement->flips, indicators},
      {&settlement->rate, switches->branch_count},
      {&settlement->was_opened, switches->contact_count},
      {&settlement->value, values},
      {&settlement->noise, values},
      {&settlement->other_noise, values},
      {&settlement->force_noise, switches->friction_count},
      {&settlement->began, switches->friction_count},
      {&settlement->condition, switches->event_count},
      {&settlement->happened, switches->event_count},
      {&settlement->takes_part, switches->contact_count + switches->friction_count},
      {&settlement->energy, switches->energy_count},
      {&settlement->acceleration, rows_of_matrix()},
      {&settlement->kept_modes, switches->mode_count},
      {&settlement->rounded, lagrangian.state_count},
      {&settlement->derivative, lagrangian.state_count},
      {&settlement->rounding, indicators},
      {&settlement->correction, lagrangian.coordinate_count + 3 * lagrangian.constraints.count},
  };
  size_t used = search_work_count();
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
    if (work != NULL) *parts[i].place = work + used;
    used += parts[i].count;
  }
  return used;
}

size_t settlement_work_count(void) {
  struct Settlement settlement;
  return lay_out_settlement(&settlement, NULL);
}

struct Settlement settlement_of(struct Instance *instance) {
  const struct SwitchTable *switches = lagrangian.switches;
  struct Settlement settlement = {.instance = instance, .switches = switches, .last = {switches->friction_count, 0, 0}};
  lay_out_settlement(&settlement, instance->switching_work);
  memset(settlement.largest, 0, (size_t)(settlement.value - settlement.largest) * sizeof(double));
  return settlement;
}

struct Settlement settlement_at(struct Instance *instance, double time, double *state, enum Occasion occasion) {
  struct Settlement settlement = settlement_of(instance);
  settlement.time = time;
  settlement.state = state;
  settlement.occasion = occasion;
  return settlement;
}

const double *settlement_accelerations(const struct Settlement *settlement) {
  return lagrangian.constraints.accelerations != NULL ? settlement->acceleration
                                                      : settlement->derivative + lagrangian.coordinate_count;
}

bool settlement_values(struct Settlement *settlement, const double *state, double *value) {
  struct Instance *instance = settlement->instance;
  struct Point point = solver_point(instance, settlement->time, state);
  if (lagrangian.constraints.accelerations != NULL)
    instance->singular = lagrangian.constraints.accelerations(&point, settlement->acceleration);
  else instance->singular = lagrangian.derivatives(&point, settlement->derivative);
  if (instance->singular != 0) return false;
  settlement->switches->switching_values(&point, settlement_accelerations(settlement), value);
  return true;
}

void settlement_values_of_force(const struct Settlement *settlement, const struct Point *point, size_t constraint,
                                double force, double *value) {
  size_t n = lagrangian.coordinate_count, constraints = lagrangian.constraints.count;
  memset(settlement->acceleration, 0, (n + constraints) * sizeof *settlement->acceleration);
  if (constraint < constraints) settlement->acceleration[n + constraint] = force;
  settlement->switches->switching_values(point, settlement->acceleration, value);
}

static void add_noise(struct Settlement *settlement, size_t place, double noise) {
  settlement->noise[place] = fmax(settlement->noise[place], noise);
}

/* Rounding error of a velocity after a jump, relative to its size before: the equations may be nearly singular. */
static const double rounding_of_jumps = 1e-11;

static void measure_velocity(struct Settlement *settlement, size_t place) {
  settlement->largest[place] = fmax(settlement->largest[place], fabs(settlement->value[place]));
  add_noise(settlement, place, rounding_of_jumps * settlement->largest[place]);
}

static bool values_rounded(struct Settlement *settlement, bool otherwise, double *value, double *factor) {
  *factor = round_state(settlement->state, otherwise, settlement->rounded);
  return settlement_values(settlement, settlement->rounded, value);
}

/* Adds rounding errors of the values' operations, which perturbations of the state miss where large terms cancel. */
static void take_roundings(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  double *rounding = settlement->rounding;
  indicator_roundings(settlement->instance, settlement->time, settlement->state, settlement_accelerations(settlement),
                      rounding);
  for (size_t i = 0; i < switches->branch_count; i++) add_noise(settlement, i, rounding[i]);
  for (size_t i = 0; i < switches->contact_count; i++)
    add_noise(settlement, contact_place(switches, i, CONTACT_GAP), rounding[contact_indicator(switches, i)]);
  for (size_t i = 0; i < switches->friction_count; i++)
    add_noise(settlement, friction_place(switches, i, FRICTION_VELOCITY), rounding[friction_indicator(switches, i)]);
}

static double holding_force(const struct Settlement *settlement, size_t friction) {
  size_t constraint = settlement->switches->frictions[friction].constraint;
  return settlement->acceleration[lagrangian.coordinate_count + constraint];
}

/* Perturbs in two patterns, so that the errors cannot cancel in both; the second one is evaluated once per event. */
bool settlement_evaluate(struct Settlement *settlement) {
  size_t count = settlement_value_count(settlement->switches);
  double *noise = settlement->noise, *other = settlement->other_noise, factor, other_factor = 0.0;
  if (evaluate_prepare(settlement->instance) != STATUS_DONE) return false;
  if (!values_rounded(settlement, false, noise, &factor)) return false;
  for (size_t i = 0; i < settlement->switches->friction_count; i++)
    settlement->force_noise[i] = holding_force(settlement, i);
  bool is_first = !settlement->is_evaluated;
  for (size_t i = 0; i < settlement->switches->friction_count && is_first; i++)
    settlement->began[i] = mode_of(settlement, settlement->switches->frictions[i].mode);
  if (is_first && !values_rounded(settlement, true, other, &other_factor)) return false;
  if (!settlement_values(settlement, settlement->state, settlement->value)) return false;
  for (size_t i = 0; i < count; i++) {
    if (is_first) other[i] = other_factor * fabs(other[i] - settlement->value[i]);
    double change = fmax(factor * fabs(noise[i] - settlement->value[i]), other[i]);
    noise[i] = isfinite(change) ? change : 0.0;
  }
  for (size_t i = 0; i < settlement->switches->friction_count; i++)
    settlement->force_noise[i] = factor * fabs(settlement->force_noise[i] - holding_force(settlement, i));
  take_roundings(settlement);
  settlement->is_evaluated = true;
  for (size_t i = 0; i < settlement->switches->contact_count; i++)
    measure_velocity(settlement, contact_place(settlement->switches, i, CONTACT_RATE));
  for (size_t i = 0; i < settlement->switches->friction_count; i++) {
    size_t velocity = friction_place(settlement->switches, i, FRICTION_VELOCITY), rate = velocity + FRICTION_RATE;
    measure_velocity(settlement, velocity);
    settlement->largest[rate] = fmax(settlement->largest[rate], fabs(settlement->value[rate]));
  }
  return true;
}

double settlement_noise(const struct Settlement *settlement, size_t place, size_t rate) {
  double change = 8.0 * DBL_EPSILON * fabs(settlement->time * settlement->value[rate]);
  return settlement->noise[place] + (isfinite(change) ? change : 0.0);
}

void settlement_set_mode(struct Settlement *settlement, size_t mode, double value) {
  settlement->instance->parameter[mode] = value;
  settlement->instance->prepared_is_stale = true;
  settlement->changed = true;
  settlement->last.friction = settlement->switches->friction_count;
}

static double *modes_of(const struct Settlement *settlement) {
  return settlement->instance->parameter + lagrangian.parameter_count - settlement->switches->mode_count;
}

void settlement_keep_modes(struct Settlement *settlement) {
  memcpy(settlement->kept_modes, modes_of(settlement), settlement->switches->mode_count * sizeof(double));
}

void settlement_restore_modes(struct Settlement *settlement) {
  memcpy(modes_of(settlement), settlement->kept_modes, settlement->switches->mode_count * sizeof(double));
  settlement->instance->prepared_is_stale = true;
}

bool settlement_push(struct Settlement *settlement) {
  struct Instance *instance = settlement->instance;
  double *velocity = settlement->state + lagrangian.coordinate_count;
  if (evaluate_prepare(instance) != STATUS_DONE) return false;
  struct Point point = solver_point(instance, settlement->time, settlement->state);
  instance->singular = lagrangian.constraints.correct_velocities(&point, settlement->correction);
  if (instance->singular != 0 || !are_finite(settlement->correction, lagrangian.coordinate_count)) return false;
  for (size_t i = 0; i < lagrangian.coordinate_count; i++) velocity[i] += settlement->correction[i];
  settlement->changed = true;
  return true;
}

bool settlement_moves(const struct Settlement *settlement, size_t constraint) {
  const double *slope = settlement->correction + lagrangian.coordinate_count + 2 * lagrangian.constraints.count;
  return slope[constraint] > 0.0;
}

bool settlement_move(struct Settlement *settlement) {
  struct Instance *instance = settlement->instance;
  memset(settlement->rounded, 0, lagrangian.state_count * sizeof *settlement->rounded);
  if (evaluate_prepare(instance) != STATUS_DONE) return false;
  struct Point point = solver_point(instance, settlement->time, settlement->state);
  struct Seed seed = {.state = settlement->rounded};
  bool keeps_fixed = settlement->occasion == AT_START && lagrangian.constraints.coordinate_is_fixed != NULL;
  instance->singular = (keeps_fixed ? lagrangian.constraints.start_positions
                                    : lagrangian.constraints.correct_positions)(&point, &seed, settlement->correction);
  if (instance->singular != 0 || !are_finite(settlement->correction, lagrangian.coordinate_count)) return false;
  for (size_t i = 0; i < lagrangian.coordinate_count; i++) settlement->state[i] += settlement->correction[i];
  settlement->changed = true;
  return true;
}
