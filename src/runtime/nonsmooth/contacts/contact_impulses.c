#include "nonsmooth/contacts/contact_impulses.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "nonsmooth/contacts/planes.h"
#include "evaluation/evaluate.h"
#include "evaluation/services.h"
#include "support/arena.h"

/* Flights shorter than this many units in the last place of the time count as rest: their ends cannot be separated. */
static const double shortest_flight = 1000.0;
/* Smaller speeds have no direction: their squares are close to underflow. */
static const double least_speed = 1e-150;
/* Bounces below this share of the tolerance are lost in errors, and some methods would sustain them. */
static const double lost_share = 0.02;

bool is_touching(const struct Resolution *resolution, size_t contact) {
  size_t gap = contact_slot(resolution->switches, contact, CONTACT_GAP);
  double error_bound = resolution_error_bound(resolution, gap, gap + CONTACT_RATE);
  return resolution->value[gap] <= error_bound || is_hit(resolution, contact_indicator(resolution->switches, contact));
}

size_t choose_touching(struct Resolution *resolution, enum Part frictions) {
  const struct SwitchTable *switches = resolution->switches;
  size_t count = 0;
  for (size_t i = 0; i < switches->contact_count; i++) {
    bool touches = is_touching(resolution, i);
    resolution->part[i] = touches ? TAKES_PART : LEFT_OUT;
    count += touches ? 1 : 0;
  }
  for (size_t i = 0; i < switches->friction_count; i++) *part_of_friction(resolution, i) = frictions;
  return count;
}

/* True if the contact has no restitution, or touches beside others. */
static bool is_in_heap(const struct Resolution *resolution, size_t contact) {
  bool is_beside = !(contact_value(resolution, contact, CONTACT_RESTITUTION) > 0.0);
  for (size_t i = 0; i < resolution->switches->contact_count && !is_beside; i++)
    is_beside = i != contact && (contact_is_closed(resolution, i) || is_touching(resolution, i));
  return is_beside;
}

/*
 * Returns the height of bounces that count as lost, the error of the method; 0 if rounding is the only error. In a heap
 * each landing causes others, ever slower ones. These are lost below the tolerance, whatever the method is.
 */
static double lost_height(const struct Resolution *resolution, size_t contact) {
  if (resolution->occasion == IN_EXCHANGE) return 0.0;
  double error = solver_error(resolution->instance);
  bool is_error = error > 0.0 || !is_in_heap(resolution, contact);
  return lost_share * (is_error ? error : solver_tolerance(resolution->instance));
}

/*
 * With the rate u at which the gap opens, and its acceleration -fall, a bounce lasts 2 u / fall and has the height
 * u^2 / (2 fall).
 */
static bool flight_is_lost(const struct Resolution *resolution, size_t contact, double rate, double fall) {
  size_t gap = contact_slot(resolution->switches, contact, CONTACT_GAP);
  double start = resolution->instance->fmu_state->start_time;
  double time_resolution = DBL_EPSILON * fmax(fabs(resolution->time), fabs(resolution->time - start));
  if (rate <= resolution->error_bound[gap + CONTACT_RATE] || 2.0 * rate <= shortest_flight * time_resolution * fall)
    return true;
  /* Rounding, or more so an importer, leaves the gap slightly negative. A flight that ends below 0 crosses no zero. */
  double depth = resolution->occasion == IN_EXCHANGE ? 10.0 : 1.0;
  double lost =
      fmax(4.0 * resolution_error_bound(resolution, gap, gap + CONTACT_RATE), -depth * resolution->value[gap]);
  return rate * rate <= 2.0 * fall * fmax(lost, lost_height(resolution, contact));
}

bool bounce_is_lost(const struct Resolution *resolution, size_t contact, double rate) {
  return flight_is_lost(resolution, contact, rate, -contact_value(resolution, contact, CONTACT_ACCELERATION));
}

/* Returns the largest size of the accelerations of all gaps. */
static double largest_acceleration_of_gaps(const struct Resolution *resolution) {
  double largest = 0.0;
  for (size_t i = 0; i < resolution->switches->contact_count; i++)
    largest = fmax(largest, fabs(contact_value(resolution, i, CONTACT_ACCELERATION)));
  return largest;
}

bool bounce_is_lost_beside_others(const struct Resolution *resolution, size_t contact, double rate) {
  return flight_is_lost(resolution, contact, rate, largest_acceleration_of_gaps(resolution));
}

/* True if the contact is closed, or touches, and its bounce is lost if its gap has the acceleration -fall. */
static bool rests_if_falling(const struct Resolution *resolution, size_t contact, double fall) {
  if (contact_is_closed(resolution, contact)) return true;
  return is_touching(resolution, contact) &&
         flight_is_lost(resolution, contact, contact_value(resolution, contact, CONTACT_RATE), fall);
}

bool contact_is_at_rest(const struct Resolution *resolution, size_t contact) {
  return rests_if_falling(resolution, contact, -contact_value(resolution, contact, CONTACT_ACCELERATION));
}

bool contact_may_rest(const struct Resolution *resolution, size_t contact) {
  return rests_if_falling(resolution, contact, largest_acceleration_of_gaps(resolution));
}

double largest_contact_force(const struct Resolution *resolution) {
  double largest = 0.0;
  for (size_t i = 0; i < resolution->switches->contact_count; i++)
    if (contact_is_closed(resolution, i)) largest = fmax(largest, fabs(contact_force(resolution, i)));
  return largest;
}

static void set_contact_and_force(struct Resolution *resolution, size_t contact, bool is_closed, double force) {
  const struct ContactMetadata *metadata = &resolution->switches->contacts[contact];
  resolution_set_mode(resolution, metadata->mode, is_closed ? 1.0 : 0.0);
  if (metadata->carried != metadata->mode) resolution_set_mode(resolution, metadata->carried, force);
}

void set_contact(struct Resolution *resolution, size_t contact, bool is_closed) {
  set_contact_and_force(resolution, contact, is_closed, 0.0);
}

void contact_carry(struct Resolution *resolution, size_t contact, double force) {
  set_contact_and_force(resolution, contact, true, force);
}

void contact_press(struct Resolution *resolution, size_t contact, double force) {
  set_contact_and_force(resolution, contact, false, force);
}

bool evaluate_velocities(struct Resolution *resolution) {
  if (evaluate_prepare(resolution->instance) != STATUS_DONE) return false;
  struct Point point = solver_point(resolution->instance, resolution->time, resolution->state);
  resolution->switches->switching_values(&point, resolution->acceleration, resolution->value);
  return true;
}

bool let_stopped_slip(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  if (switches->plane_count == 0) return true;
  if (!evaluate_velocities(resolution)) return false;
  for (size_t i = 0; i < switches->plane_count; i++) {
    size_t along = switches->planes[i].along, velocity = friction_slot(switches, along, FRICTION_VELOCITY);
    double none = fmax(least_speed, resolution->error_bound[velocity]);
    bool slides = plane_mode(resolution, &switches->planes[i]) > PLANE_STICKS;
    if (slides && !(speed_in_plane(resolution, along) > none)) set_friction(resolution, along, 1.0);
  }
  return true;
}

void let_unpressed_slide(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->friction_count; i++) {
    bool rests = false, presses = false;
    for (size_t k = 0; k < switches->contact_count; k++) {
      if (!rests_on(switches, i, k)) continue;
      rests = true;
      presses |= contact_is_closed(resolution, k);
    }
    if (!rests || presses || !friction_sticks(resolution, i)) continue;
    set_friction(resolution, i, 1.0);
  }
}

double sliding_share(const struct Resolution *resolution, size_t friction) {
  const struct SwitchTable *switches = resolution->switches;
  size_t plane = plane_of(switches, friction);
  if (plane == switches->plane_count) return mode_of(resolution, switches->frictions[friction].mode);
  const struct PlaneMetadata *metadata = &switches->planes[plane];
  double speed = speed_in_plane(resolution, metadata->along);
  enum PlaneMode mode = plane_mode(resolution, metadata);
  if (mode == PLANE_IMPENDS || mode == PLANE_CARRIES || (mode == PLANE_IS_FREE && speed == 0.0))
    return mode_of(resolution, metadata->slip_direction[friction - metadata->along]);
  return resolution->value[friction_slot(switches, friction, FRICTION_VELOCITY)] / speed;
}

/* The caller selects contacts and frictions by enum Part. */
static bool contact_takes_part(const struct Resolution *resolution, size_t contact) {
  return resolution->part[contact] != LEFT_OUT;
}

static bool friction_takes_part(const struct Resolution *resolution, size_t friction) {
  const struct SwitchTable *switches = resolution->switches;
  bool rests = false;
  for (size_t i = 0; i < switches->contact_count; i++)
    rests |= contact_takes_part(resolution, i) && rests_on(switches, friction, i);
  return rests && !switches->frictions[friction].is_given && *part_of_friction(resolution, friction) != LEFT_OUT;
}

static size_t constraint_of(const struct ContactImpulses *impulses, const struct SwitchTable *switches, size_t row) {
  size_t member = impulses->member[row];
  return row < impulses->contact_count ? switches->contacts[member].constraint : switches->frictions[member].constraint;
}

/*
 * Computes the change of the velocities by the unit impulse of a constraint in response, then the generalized impulse,
 * each of n numbers. impulse is 0. False if M is singular.
 */
static bool respond_to_unit(struct Resolution *resolution, size_t constraint, bool repeats, double *impulse,
                            double *response) {
  struct Instance *instance = resolution->instance;
  struct Point point = solver_point(instance, resolution->time, resolution->state);
  double *unit = &impulse[lagrangian.coordinate_count + constraint];
  *unit = 1.0;
  instance->singular = lagrangian.constraints.respond(&point, repeats, impulse, response);
  *unit = 0.0;
  return instance->singular == 0 && are_finite(response, 2 * lagrangian.coordinate_count);
}

/*
 * Computes the effect of each unit impulse: the generalized impulses in jacobian_row (count rows, those of J), and M^-1
 * J^T in impulses->velocities; then their products W. False if M is singular.
 */
static bool respond_to_impulses(struct Resolution *resolution, struct ContactImpulses *impulses) {
  size_t n = lagrangian.coordinate_count;
  if (evaluate_prepare(resolution->instance) != STATUS_DONE) return false;
  for (size_t row = 0; row < impulses->count; row++) {
    if (!respond_to_unit(resolution, constraint_of(impulses, resolution->switches, row), row > 0, impulses->impulse,
                         impulses->response))
      return false;
    memcpy(impulses->velocities + row * n, impulses->response, n * sizeof *impulses->response);
    memcpy(impulses->jacobian_row + row * n, impulses->response + n, n * sizeof *impulses->response);
  }
  for (size_t i = 0; i < impulses->count; i++)
    for (size_t j = 0; j < impulses->count; j++) {
      double *delassus = &impulses->delassus[i * impulses->count + j];
      *delassus = 0.0;
      for (size_t k = 0; k < n; k++) *delassus += impulses->jacobian_row[i * n + k] * impulses->velocities[j * n + k];
    }
  return true;
}

/* Computes the friction limits by unit contact forces: differences to the limits without force, as these are linear. */
static void find_coefficients(struct Resolution *resolution, struct ContactImpulses *impulses) {
  double *force = impulses->impulse, *value = impulses->value;
  struct Point point = solver_point(resolution->instance, resolution->time, resolution->state);
  size_t contacts = impulses->contact_count, n = lagrangian.coordinate_count;
  for (size_t i = 0; i <= contacts && impulses->friction_count > 0; i++) {
    if (i < contacts) force[n + constraint_of(impulses, resolution->switches, i)] = 1.0;
    resolution->switches->switching_values(&point, force, value);
    if (i < contacts) force[n + constraint_of(impulses, resolution->switches, i)] = 0.0;
    for (size_t f = 0; f < impulses->friction_count; f++) {
      double sliding = value[friction_slot(resolution->switches, impulses->member[contacts + f], FRICTION_FORCE)];
      if (i < contacts) impulses->coefficient[f * contacts + i] = sliding;
      else /* without any contact force */
        for (size_t k = 0; k < contacts; k++)
          impulses->coefficient[f * contacts + k] = fmax(impulses->coefficient[f * contacts + k] - sliding, 0.0);
    }
  }
}

size_t rate_slot(const struct SwitchTable *switches, const struct ContactImpulses *impulses, size_t row) {
  return row < impulses->contact_count ? contact_slot(switches, impulses->member[row], CONTACT_RATE)
                                       : friction_slot(switches, impulses->member[row], FRICTION_VELOCITY);
}

size_t change_slot(const struct SwitchTable *switches, const struct ContactImpulses *impulses, size_t row) {
  return row < impulses->contact_count ? contact_slot(switches, impulses->member[row], CONTACT_ACCELERATION)
                                       : friction_slot(switches, impulses->member[row], FRICTION_RATE);
}

static void find_rates(const struct Resolution *resolution, struct ContactImpulses *impulses) {
  for (size_t row = 0; row < impulses->count; row++) {
    size_t slot = rate_slot(resolution->switches, impulses, row);
    impulses->rate[row] = resolution->value[slot];
    impulses->rounding = fmax(impulses->rounding, resolution->error_bound[slot]);
  }
}

static size_t lay_out_impulses(struct ContactImpulses *impulses, void *block) {
  size_t n = lagrangian.coordinate_count, count = impulses->count;
  struct Arena arena = {(uintptr_t)block};
  ARENA_NUMBERS(&arena, count * n, &impulses->velocities, &impulses->jacobian_row);
  ARENA_NUMBERS(&arena, count * count, &impulses->delassus);
  ARENA_NUMBERS(&arena, count, &impulses->rate);
  ARENA_NUMBERS(&arena, impulses->friction_count * impulses->contact_count, &impulses->coefficient);
  ARENA_NUMBERS(&arena, n + lagrangian.constraints.count, &impulses->impulse);
  ARENA_NUMBERS(&arena, 2 * n, &impulses->response);
  ARENA_NUMBERS(&arena, resolution_value_count(lagrangian.switches), &impulses->value);
  ARENA_TAKE(&arena, impulses->member, count);
  return arena.next - (uintptr_t)block;
}

bool contact_impulses_create(struct Resolution *resolution, struct ContactImpulses *impulses) {
  const struct SwitchTable *switches = resolution->switches;
  size_t contacts = 0, frictions = 0;
  for (size_t i = 0; i < switches->contact_count; i++) contacts += contact_takes_part(resolution, i) ? 1 : 0;
  for (size_t i = 0; i < switches->friction_count; i++) frictions += friction_takes_part(resolution, i) ? 1 : 0;
  *impulses = (struct ContactImpulses){.contact_count = contacts,
                                       .friction_count = frictions,
                                       .count = contacts + frictions,
                                       .deciding_count = contacts,
                                       .uncertain = resolution->tolerances.uncertain};
  impulses->block = scratch_take(resolution->instance, SCRATCH_IMPULSES, lay_out_impulses(impulses, NULL));
  if (impulses->block == NULL) {
    solver_is_out_of_memory(resolution->instance);
    return false;
  }
  lay_out_impulses(impulses, impulses->block);
  size_t next = 0;
  for (size_t i = 0; i < switches->contact_count; i++)
    if (contact_takes_part(resolution, i)) impulses->member[next++] = i;
  for (size_t i = 0; i < switches->friction_count; i++)
    if (friction_takes_part(resolution, i)) impulses->member[next++] = i;
  if (respond_to_impulses(resolution, impulses)) {
    find_coefficients(resolution, impulses);
    find_rates(resolution, impulses);
    return true;
  }
  contact_impulses_free(resolution, impulses);
  return false;
}

bool contact_impulses_find_own(struct Resolution *resolution, const struct ContactImpulses *impulses, double *own) {
  const struct SwitchTable *switches = resolution->switches;
  size_t n = lagrangian.coordinate_count;
  bool changed = resolution->changed;
  resolution_keep_modes(resolution);
  for (size_t i = 0; i < switches->contact_count; i++) set_contact(resolution, i, false);
  for (size_t i = 0; i < switches->friction_count; i++) set_friction(resolution, i, 1.0);
  double *impulse = impulses->impulse, *response = impulses->response;
  bool done = evaluate_prepare(resolution->instance) == STATUS_DONE;
  for (size_t i = 0; i < impulses->contact_count && done; i++) {
    done = respond_to_unit(resolution, constraint_of(impulses, switches, i), i > 0, impulse, response);
    own[i] = 0.0;
    for (size_t k = 0; k < n; k++) own[i] += response[n + k] * response[k];
  }
  resolution_restore_modes(resolution);
  resolution->changed = changed;
  return done;
}

void contact_impulses_free(const struct Resolution *resolution, struct ContactImpulses *impulses) {
  scratch_return(resolution->instance, SCRATCH_IMPULSES);
  impulses->block = NULL;
}
