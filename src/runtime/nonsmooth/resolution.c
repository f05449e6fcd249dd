#include "nonsmooth/resolution.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "evaluation/services.h"
#include "instance/active_constraints.h"
#include "detection/indicators.h"
#include "detection/search.h"
#include "support/arena.h"

size_t resolution_value_count(const struct SwitchTable *switches) {
  return sample_slot(switches, switches->sample_count, 0);
}

static size_t rows_of_matrix(void) {
  return lagrangian.coordinate_count + lagrangian.constraints.count;
}

/* The workspace of search.c comes first. The arrays before `value`, `forced` and `has_shared` are initially 0. */
static size_t lay_out_resolution(struct Resolution *resolution, double *work) {
  const struct SwitchTable *switches = lagrangian.switches;
  size_t values = resolution_value_count(switches), indicators = indicator_count(switches);
  size_t modes = switches->contact_count + switches->friction_count;
  struct Arena arena = {(uintptr_t)work};
  arena_take(&arena, search_work_count(), sizeof(double));
  ARENA_NUMBERS(&arena, values, &resolution->largest);
  ARENA_NUMBERS(&arena, indicators, &resolution->flips);
  ARENA_NUMBERS(&arena, switches->branch_count, &resolution->rate, &resolution->absent);
  ARENA_NUMBERS(&arena, switches->contact_count, &resolution->struck, &resolution->start_gap);
  ARENA_NUMBERS(&arena, values, &resolution->value, &resolution->error_bound, &resolution->other_error_bound);
  ARENA_NUMBERS(&arena, switches->friction_count, &resolution->force_error_bound, &resolution->began,
                &resolution->first_rate);
  ARENA_NUMBERS(&arena, switches->event_count, &resolution->condition, &resolution->happened);
  ARENA_NUMBERS(&arena, switches->resting_count, &resolution->moves);
  if (switches->resting_count > 0) {
    ARENA_NUMBERS(&arena, lagrangian.input_count, &resolution->probe_input);
    ARENA_NUMBERS(&arena, rows_of_matrix(), &resolution->probe_acceleration);
  }
  ARENA_NUMBERS(&arena, 2 * switches->resting_count, &resolution->probe_sums);
  ARENA_NUMBERS(&arena, switches->ball_count, &resolution->ball_distance);
  ARENA_NUMBERS(&arena, switches->energy_count, &resolution->energy);
  ARENA_NUMBERS(&arena, rows_of_matrix(), &resolution->acceleration);
  ARENA_NUMBERS(&arena, switches->mode_count, &resolution->kept_modes, &resolution->first_modes);
  ARENA_NUMBERS(&arena, lagrangian.state_count, &resolution->rounded, &resolution->derivative);
  ARENA_NUMBERS(&arena, indicators, &resolution->rounding);
  ARENA_NUMBERS(&arena, rows_of_matrix() + 2 * lagrangian.constraints.count, &resolution->correction);
  ARENA_TAKE(&arena, resolution->forced, switches->contact_count);
  ARENA_TAKE(&arena, resolution->has_shared, switches->contact_count);
  ARENA_TAKE(&arena, resolution->part, modes);
  ARENA_NUMBERS(&arena, modes, &resolution->guess);
  return (arena.next - (uintptr_t)work + sizeof(double) - 1) / sizeof(double);
}

size_t resolution_work_count(void) {
  struct Resolution resolution;
  return lay_out_resolution(&resolution, NULL);
}

struct Resolution resolution_of(struct Instance *instance) {
  const struct SwitchTable *switches = lagrangian.switches;
  struct Resolution resolution = {.instance = instance, .switches = switches};
  lay_out_resolution(&resolution, instance->switching_work);
  memset(resolution.largest, 0, (size_t)(resolution.value - resolution.largest) * sizeof(double));
  memset(resolution.forced, 0, switches->contact_count * sizeof *resolution.forced);
  memset(resolution.has_shared, 0, switches->contact_count * sizeof *resolution.has_shared);
  return resolution;
}

struct Resolution resolution_at(struct Instance *instance, double time, double *state, enum Occasion occasion) {
  struct Resolution resolution = resolution_of(instance);
  resolution.time = time;
  resolution.state = state;
  resolution.occasion = occasion;
  return resolution;
}

const double *resolution_accelerations(const struct Resolution *resolution) {
  return lagrangian.constraints.accelerations != NULL ? resolution->acceleration
                                                      : resolution->derivative + lagrangian.coordinate_count;
}

static bool find_accelerations(struct Resolution *resolution, const struct Point *point) {
  struct Instance *instance = resolution->instance;
  if (lagrangian.constraints.accelerations != NULL)
    instance->singular = lagrangian.constraints.accelerations(point, resolution->acceleration);
  else instance->singular = lagrangian.derivatives(point, resolution->derivative);
  return instance->singular == 0;
}

bool resolution_find_accelerations(struct Resolution *resolution) {
  if (evaluate_prepare(resolution->instance) != STATUS_DONE) return false;
  struct Point point = solver_point(resolution->instance, resolution->time, resolution->state);
  return find_accelerations(resolution, &point);
}

bool resolution_values_near(struct Resolution *resolution, double time, const double *state, double *value) {
  struct Point point = solver_point(resolution->instance, time, state);
  if (!resolution->keeps_accelerations && !find_accelerations(resolution, &point)) return false;
  resolution->switches->switching_values(&point, resolution_accelerations(resolution), value);
  return true;
}

bool resolution_values(struct Resolution *resolution, const double *state, double *value) {
  return resolution_values_near(resolution, resolution->time, state, value);
}

void resolution_values_of_force(const struct Resolution *resolution, const struct Point *point, size_t constraint,
                                double force, double *value) {
  size_t n = lagrangian.coordinate_count, constraints = lagrangian.constraints.count;
  memset(resolution->acceleration, 0, (n + constraints) * sizeof *resolution->acceleration);
  if (constraint < constraints) resolution->acceleration[n + constraint] = force;
  resolution->switches->switching_values(point, resolution->acceleration, value);
}

static void add_error_bound(struct Resolution *resolution, size_t slot, double error_bound) {
  resolution->error_bound[slot] = fmax(resolution->error_bound[slot], error_bound);
}

/* Relative rounding error bound of time, in units of DBL_EPSILON. */
static const double time_rounding = 8.0;

/* Rounding error of a velocity after a jump, relative to its size before: the equations may be nearly singular. */
static const double rounding_of_jumps = 1e-11;

static void measure_velocity(struct Resolution *resolution, size_t slot) {
  resolution->largest[slot] = fmax(resolution->largest[slot], fabs(resolution->value[slot]));
  add_error_bound(resolution, slot, rounding_of_jumps * resolution->largest[slot]);
}

/* Evaluates the values at a perturbed state and time; the factor gives rounding error bounds from their changes. */
static bool values_rounded(struct Resolution *resolution, bool otherwise, double *value, double *factor) {
  *factor = round_state(resolution->state, otherwise, resolution->rounded);
  double change = time_rounding / *factor * DBL_EPSILON * (otherwise ? -1.0 : 1.0);
  return resolution_values_near(resolution, resolution->time * (1.0 + change), resolution->rounded, value);
}

/* Adds rounding errors of the values' operations, which perturbations of the state miss where large terms cancel. */
static void take_rounding_bounds(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  double *rounding = resolution->rounding;
  indicator_rounding_bounds(resolution->instance, resolution->time, resolution->state,
                            resolution_accelerations(resolution), rounding);
  for (size_t i = 0; i < switches->branch_count; i++) add_error_bound(resolution, i, rounding[i]);
  for (size_t i = 0; i < switches->contact_count; i++)
    add_error_bound(resolution, contact_slot(switches, i, CONTACT_GAP), rounding[contact_indicator(switches, i)]);
  for (size_t i = 0; i < switches->friction_count; i++)
    add_error_bound(resolution, friction_slot(switches, i, FRICTION_VELOCITY),
                    rounding[friction_indicator(switches, i)]);
}

static double holding_force(const struct Resolution *resolution, size_t friction) {
  size_t constraint = resolution->switches->frictions[friction].constraint;
  return resolution->acceleration[lagrangian.coordinate_count + constraint];
}

/* Perturbs in two patterns, so that the errors cannot cancel in both; the second one is evaluated once per event. */
bool resolution_evaluate(struct Resolution *resolution) {
  size_t count = resolution_value_count(resolution->switches);
  double *error_bound = resolution->error_bound, *other = resolution->other_error_bound, factor, other_factor = 0.0;
  resolution->instance->fmu_state->statistics[STATISTIC_ROUNDS]++;
  if (evaluate_prepare(resolution->instance) != STATUS_DONE) return false;
  if (!values_rounded(resolution, false, error_bound, &factor)) return false;
  for (size_t i = 0; i < resolution->switches->friction_count; i++)
    resolution->force_error_bound[i] = holding_force(resolution, i);
  bool is_first = !resolution->is_evaluated;
  for (size_t i = 0; i < resolution->switches->friction_count && is_first; i++)
    resolution->began[i] = mode_of(resolution, resolution->switches->frictions[i].mode);
  if (is_first && !values_rounded(resolution, true, other, &other_factor)) return false;
  if (!resolution_values(resolution, resolution->state, resolution->value)) return false;
  for (size_t i = 0; i < count; i++) {
    if (is_first) other[i] = other_factor * fabs(other[i] - resolution->value[i]);
    double change = fmax(factor * fabs(error_bound[i] - resolution->value[i]), other[i]);
    error_bound[i] = isfinite(change) ? change : 0.0;
  }
  for (size_t i = 0; i < resolution->switches->friction_count; i++)
    resolution->force_error_bound[i] = factor * fabs(resolution->force_error_bound[i] - holding_force(resolution, i));
  take_rounding_bounds(resolution);
  resolution->tolerances = tolerances_of(resolution);
  resolution->is_evaluated = true;
  for (size_t i = 0; i < resolution->switches->contact_count; i++)
    measure_velocity(resolution, contact_slot(resolution->switches, i, CONTACT_RATE));
  for (size_t i = 0; i < resolution->switches->friction_count; i++) {
    size_t velocity = friction_slot(resolution->switches, i, FRICTION_VELOCITY), rate = velocity + FRICTION_RATE;
    measure_velocity(resolution, velocity);
    resolution->largest[rate] = fmax(resolution->largest[rate], fabs(resolution->value[rate]));
    if (is_first) resolution->first_rate[i] = fabs(resolution->value[rate]);
  }
  return true;
}

bool resolution_evaluate_rates(struct Resolution *resolution) {
  resolution->keeps_accelerations = true;
  bool is_done = resolution_evaluate(resolution);
  resolution->keeps_accelerations = false;
  return is_done;
}

double resolution_error_bound(const struct Resolution *resolution, size_t slot, size_t rate) {
  double change = time_rounding * DBL_EPSILON * fabs(resolution->time * resolution->value[rate]);
  return resolution->error_bound[slot] + (isfinite(change) ? change : 0.0);
}

void resolution_set_mode(struct Resolution *resolution, size_t mode, double value) {
  resolution->instance->parameter[mode] = value;
  resolution->instance->parameter_constants_are_stale = true;
  resolution->changed = true;
}

bool resolution_has_changed(const struct Resolution *resolution) {
  const double *mode = modes_of(resolution->instance), *first = resolution->first_modes;
  bool changes = resolution->jumped || resolution->is_projected;
  for (size_t i = 0; i < resolution->switches->mode_count; i++) changes |= mode[i] != first[i];
  return resolution->changed && changes;
}

void set_friction(struct Resolution *resolution, size_t friction, double mode) {
  const struct SwitchTable *switches = resolution->switches;
  size_t plane = plane_of(switches, friction);
  if (plane < switches->plane_count) switches->friction_laws->set_plane(resolution, plane, mode != 0.0);
  else {
    const struct FrictionMetadata *metadata = &switches->frictions[friction];
    resolution_set_mode(resolution, metadata->mode, mode);
    if (metadata->share != metadata->mode) resolution_set_mode(resolution, metadata->share, 0.0);
  }
}

void resolution_keep_modes(struct Resolution *resolution) {
  memcpy(resolution->kept_modes, modes_of(resolution->instance), resolution->switches->mode_count * sizeof(double));
}

void resolution_restore_modes(struct Resolution *resolution) {
  memcpy(modes_of(resolution->instance), resolution->kept_modes, resolution->switches->mode_count * sizeof(double));
  resolution->instance->parameter_constants_are_stale = true;
}

bool resolution_find_correction(struct Resolution *resolution) {
  struct Instance *instance = resolution->instance;
  if (evaluate_prepare(instance) != STATUS_DONE) return false;
  struct Point point = solver_point(instance, resolution->time, resolution->state);
  instance->singular = lagrangian.constraints.correct_velocities(&point, resolution->correction);
  return instance->singular == 0 && are_finite(resolution->correction, lagrangian.coordinate_count);
}

bool resolution_project_velocities(struct Resolution *resolution) {
  double *velocity = resolution->state + lagrangian.coordinate_count;
  if (!resolution_find_correction(resolution)) return false;
  for (size_t i = 0; i < lagrangian.coordinate_count; i++) velocity[i] += resolution->correction[i];
  resolution->changed = resolution->is_projected = true;
  return true;
}

bool resolution_moves(const struct Resolution *resolution, size_t constraint) {
  const double *slope = resolution->correction + lagrangian.coordinate_count + 2 * lagrangian.constraints.count;
  return slope[constraint] > 0.0;
}

bool resolution_project_coordinates(struct Resolution *resolution) {
  struct Instance *instance = resolution->instance;
  memset(resolution->rounded, 0, lagrangian.state_count * sizeof *resolution->rounded);
  if (evaluate_prepare(instance) != STATUS_DONE) return false;
  struct Point point = solver_point(instance, resolution->time, resolution->state);
  struct Seed seed = {.state = resolution->rounded};
  bool keeps_fixed = resolution->occasion == AT_START && lagrangian.constraints.coordinate_is_fixed != NULL;
  instance->singular = (keeps_fixed ? lagrangian.constraints.start_positions
                                    : lagrangian.constraints.correct_positions)(&point, &seed, resolution->correction);
  if (instance->singular != 0 || !are_finite(resolution->correction, lagrangian.coordinate_count)) return false;
  for (size_t i = 0; i < lagrangian.coordinate_count; i++) resolution->state[i] += resolution->correction[i];
  resolution->changed = resolution->is_projected = true;
  return true;
}
