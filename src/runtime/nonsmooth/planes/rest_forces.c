/*
 * Forces of frictions in planes at rest, and of contacts at rest. With the accelerations a they fulfil the law of
 * cone_search.c; the force T of a friction fulfils
 *
 *   |T| <= limit,  and  a = 0 or T = -limit a / |a|.
 *
 * The accelerations and the limits are linear functions of the forces. They are read from the equations of motion: at
 * one force after another, with a force in place of each constraint. The limit of a friction that begins to slip falls
 * to the kinetic friction; the forces are then found again.
 */
#include "nonsmooth/planes/rest_forces.h"

#include <math.h>
#include <string.h>

#include "nonsmooth/contacts/contact_impulses.h"
#include "evaluation/services.h"
#include "nonsmooth/cones/cone_impulses.h"
#include "nonsmooth/cones/cones.h"
#include "support/arena.h"

/* Relative to the largest acceleration: smaller ones are rounding errors. */
static const double rounded_share = 1e-9;

/*
 * Relative to the limit: a friction that was overcome slips within this margin of it. A smaller one is lost in rounding
 * where frictions share a load.
 */
static const double least_margin = 1e-7;

/*
 * In units of the kinetic friction, or of the pressure: the change of a force by which the linear functions are read.
 * Larger frictions may jam contacts.
 */
static const double trial_share = 0.1;

double largest_stiction(const struct Resolution *resolution) {
  double largest = 0.0;
  for (size_t i = 0; i < resolution->switches->plane_count; i++)
    largest = fmax(largest, plane_state(resolution, i).stiction);
  return largest;
}

static bool row_is_of_contact(const struct RestForces *forces, size_t row) {
  return row < forces->impulses.contact_count;
}

/* Returns the row of an array of frictions. */
static size_t friction_of_row(const struct RestForces *forces, size_t row) {
  return row - forces->impulses.contact_count;
}

/* True if the force of a friction at rest is unknown: it has kinetic friction, in units of which it is found. */
static bool has_unknown_force(const struct Resolution *resolution, const struct PlaneState *state) {
  return *part_of_plane(resolution, state) != 0.0 && state->sliding > 0.0;
}

static size_t lay_out_forces(struct RestForces *forces, void *block) {
  size_t n = forces->n, frictions = forces->impulses.friction_count;
  struct Arena arena = {(uintptr_t)block};
  ARENA_NUMBERS(&arena, n * n, &forces->impulses.delassus);
  ARENA_NUMBERS(&arena, n, &forces->free, &forces->force, &forces->behind);
  ARENA_NUMBERS(&arena, frictions * n, &forces->impulses.coefficient, &forces->stiction, &forces->kinetic);
  ARENA_NUMBERS(&arena, frictions, &forces->impulses.given, &forces->given_stiction, &forces->given_kinetic,
                &forces->slips);
  ARENA_TAKE(&arena, forces->impulses.member, n);
  return arena.next - (uintptr_t)block;
}

/* Counts the rows, and takes the workspace. False without memory. */
static bool create_forces(struct RestForces *forces) {
  struct Resolution *resolution = forces->resolution;
  const struct SwitchTable *switches = resolution->switches;
  size_t contacts = 0, frictions = 0;
  for (size_t i = 0; i < switches->contact_count; i++) contacts += resolution->takes_part[i] != 0.0 ? 1 : 0;
  for (size_t i = 0; i < switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    frictions += has_unknown_force(resolution, &state) ? 2 : 0;
  }
  size_t n = forces->n = contacts + frictions;
  forces->impulses =
      (struct ContactImpulses){.contact_count = contacts, .friction_count = frictions, .count = n, .deciding_count = n};
  void *block = scratch_take(resolution->instance, SCRATCH_RESTS, lay_out_forces(forces, NULL));
  if (block == NULL) {
    solver_is_out_of_memory(resolution->instance);
    return false;
  }
  lay_out_forces(forces, block);
  size_t row = 0;
  for (size_t i = 0; i < switches->contact_count; i++)
    if (resolution->takes_part[i] != 0.0) forces->impulses.member[row++] = i;
  for (size_t i = 0; i < switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    if (!has_unknown_force(resolution, &state)) continue;
    for (size_t side = 0; side < 2; side++) forces->impulses.member[row++] = state.metadata->along + side;
  }
  return true;
}

/*
 * Opens the contacts that take part, and presses on them in place of their constraints: the limits of frictions on them
 * are then not 0. False if accelerations do not exist.
 */
static bool press_on_contacts(struct RestForces *forces) {
  struct Resolution *resolution = forces->resolution;
  double largest = largest_contact_force(resolution);
  forces->pressure = largest > 0.0 ? largest : 1.0;
  bool presses = false;
  for (size_t i = 0; i < resolution->switches->contact_count; i++) {
    if (resolution->takes_part[i] == 0.0) continue;
    contact_press(resolution, i, forces->pressure);
    presses = true;
  }
  return !presses || plane_evaluate(resolution);
}

static double limit_of_row(const struct RestForces *forces, size_t row, size_t kind) {
  return forces->resolution->value[friction_slot(forces->resolution->switches, forces->impulses.member[row], kind)];
}

/* Changes the force of a row by a share of its unit: that of a friction is its kinetic one, against its direction. */
static void set_share(const struct RestForces *forces, size_t row, double share) {
  size_t member = forces->impulses.member[row];
  if (row_is_of_contact(forces, row)) {
    contact_press(forces->resolution, member, (1.0 + share) * forces->pressure);
    return;
  }
  struct PlaneState state = state_of_row(forces, row);
  resolution_set_mode(forces->resolution, state.metadata->slip_direction[member - state.metadata->along], share);
}

/* Returns the unit of a row in the last evaluation. */
static double unit_of_row(const struct RestForces *forces, size_t row) {
  return row_is_of_contact(forces, row) ? forces->pressure : -limit_of_row(forces, row, FRICTION_FORCE);
}

/* Returns the acceleration of a row in the last evaluation. */
static double acceleration_of_row(const struct RestForces *forces, size_t row) {
  size_t member = forces->impulses.member[row];
  if (row_is_of_contact(forces, row)) return contact_value(forces->resolution, member, CONTACT_ACCELERATION);
  return forces->resolution->value[friction_slot(forces->resolution->switches, member, FRICTION_RATE)];
}

/* Fills the derivatives by the force of one row. False if accelerations do not exist. */
static bool fill_column(struct RestForces *forces, size_t column) {
  size_t n = forces->n;
  set_share(forces, column, trial_share);
  bool exist = plane_evaluate(forces->resolution);
  double force = exist ? trial_share * unit_of_row(forces, column) : 0.0;
  for (size_t row = 0; row < n && force != 0.0; row++) {
    forces->impulses.delassus[row * n + column] = (acceleration_of_row(forces, row) - forces->free[row]) / force;
    if (row_is_of_contact(forces, row)) continue;
    size_t friction = friction_of_row(forces, row), element = friction * n + column;
    forces->stiction[element] =
        (limit_of_row(forces, row, FRICTION_STICTION) - forces->given_stiction[friction]) / force;
    forces->kinetic[element] = (limit_of_row(forces, row, FRICTION_FORCE) - forces->given_kinetic[friction]) / force;
  }
  set_share(forces, column, 0.0);
  return exist;
}

/* Subtracts the effect of the pressure on the contacts. */
static void subtract_pressure(struct RestForces *forces) {
  size_t n = forces->n;
  for (size_t row = 0; row < n; row++)
    for (size_t j = 0; j < forces->impulses.contact_count; j++) {
      forces->free[row] -= forces->impulses.delassus[row * n + j] * forces->pressure;
      if (row_is_of_contact(forces, row)) continue;
      size_t friction = friction_of_row(forces, row);
      forces->given_stiction[friction] -= forces->stiction[friction * n + j] * forces->pressure;
      forces->given_kinetic[friction] -= forces->kinetic[friction * n + j] * forces->pressure;
    }
}

/* Reads the linear functions. False if accelerations do not exist. */
static bool fill_functions(struct RestForces *forces) {
  for (size_t row = forces->impulses.contact_count; row < forces->n; row++) {
    struct PlaneState state = state_of_row(forces, row);
    plane_release(forces->resolution, &state);
    set_share(forces, row, 0.0);
  }
  bool exist = plane_evaluate(forces->resolution);
  for (size_t row = 0; row < forces->n; row++) {
    forces->free[row] = acceleration_of_row(forces, row);
    if (row_is_of_contact(forces, row)) continue;
    forces->given_stiction[friction_of_row(forces, row)] = limit_of_row(forces, row, FRICTION_STICTION);
    forces->given_kinetic[friction_of_row(forces, row)] = limit_of_row(forces, row, FRICTION_FORCE);
  }
  for (size_t column = 0; column < forces->n && exist; column++) exist = fill_column(forces, column);
  subtract_pressure(forces);
  return exist;
}

static void fill_limits(struct RestForces *forces) {
  size_t n = forces->n, contacts = forces->impulses.contact_count;
  for (size_t friction = 0; friction < forces->impulses.friction_count; friction++) {
    bool is_kinetic = rest_slips(forces, contacts + friction);
    forces->impulses.given[friction] = (is_kinetic ? forces->given_kinetic : forces->given_stiction)[friction];
    memcpy(forces->impulses.coefficient + friction * n,
           (is_kinetic ? forces->kinetic : forces->stiction) + friction * n, n * sizeof(double));
  }
}

/* Returns the limit of the friction of a row with the forces, given it without them and its derivatives. */
static double limit_at(const struct RestForces *forces, size_t row, const double *given, const double *derivative) {
  size_t friction = friction_of_row(forces, row);
  double limit = given[friction];
  for (size_t j = 0; j < forces->n; j++) limit += derivative[friction * forces->n + j] * forces->force[j];
  return limit;
}

/* True if a friction accelerates by the solution. */
static bool accelerates(const struct RestForces *forces, size_t row) {
  return hypot(forces->behind[row], forces->behind[row + 1]) > forces->none;
}

/* True if a friction accelerates by the solution, or was overcome and is at its limit. */
static bool begins_to_slip(const struct RestForces *forces, size_t row) {
  struct PlaneState state = state_of_row(forces, row);
  if (accelerates(forces, row)) return true;
  if (*part_of_plane(forces->resolution, &state) != IS_OVERCOME) return false;
  double limit = limit_at(forces, row, forces->impulses.given, forces->impulses.coefficient);
  double rounding = share_at_limit * largest_stiction(forces->resolution),
         response = forces->impulses.delassus[row * (forces->n + 1)];
  double least = (1.0 - least_margin) * limit - rounding - (response > 0.0 ? forces->none / response : 0.0);
  return hypot(forces->force[row], forces->force[row + 1]) >= least;
}

/* Marks the frictions that slip, which have their kinetic limit. True if a limit falls. */
static bool lower_limits(struct RestForces *forces) {
  bool falls = false;
  for (size_t row = forces->impulses.contact_count; row < forces->n; row += 2) {
    if (rest_slips(forces, row) || !begins_to_slip(forces, row)) continue;
    falls |= limit_at(forces, row, forces->given_stiction, forces->stiction) >
             (1.0 + share_at_limit) * limit_at(forces, row, forces->given_kinetic, forces->kinetic);
    size_t friction = friction_of_row(forces, row);
    forces->slips[friction] = forces->slips[friction + 1] = 1.0;
  }
  return falls;
}

/* Finds the forces. False if there are none. */
static bool solve_law(struct RestForces *forces) {
  double error;
  if (!fill_functions(forces)) return false;
  do {
    fill_limits(forces);
    if (!cone_forces_find(forces->resolution, &forces->impulses, forces->free, forces->force, &error)) return false;
    double largest = fill_rates_behind(&forces->impulses, forces->free, forces->force, forces->behind);
    forces->none = fmax(rounded_share * largest, error);
    forces->resolution->least_acceleration = forces->none;
  } while (lower_limits(forces));
  return true;
}

bool rest_forces_find(struct RestForces *forces) {
  if (!press_on_contacts(forces) || !create_forces(forces)) return false;
  if (forces->n == 0 || solve_law(forces)) return true;
  rest_forces_free(forces);
  return false;
}

double rest_forces_kinetic(const struct RestForces *forces, size_t row) {
  return limit_at(forces, row, forces->given_kinetic, forces->kinetic);
}

void rest_forces_free(const struct RestForces *forces) {
  scratch_return(forces->resolution->instance, SCRATCH_RESTS);
}
