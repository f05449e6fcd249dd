/*
 * Forces of frictions at rest, and of contacts at rest. With the accelerations a they fulfil the law of
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
#include "nonsmooth/planes/lines_at_rest.h"
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
  for (size_t i = 0; i < resolution->switches->friction_count; i++)
    largest = fmax(largest, resolution->value[friction_slot(resolution->switches, i, FRICTION_STICTION)]);
  return largest;
}

static bool row_is_of_contact(const struct RestForces *forces, size_t row) {
  return row < forces->impulses.contact_count;
}

/* Returns the row of an array of frictions. */
static size_t friction_of_row(const struct RestForces *forces, size_t row) {
  return row - forces->impulses.contact_count;
}

bool rest_is_unknown(const struct Resolution *resolution, size_t friction) {
  double sliding = resolution->value[friction_slot(resolution->switches, friction, FRICTION_FORCE)];
  return *part_of_friction(resolution, friction) != LEFT_OUT && sliding != 0.0;
}

static size_t lay_out_forces(struct RestForces *forces, void *block) {
  size_t n = forces->n, frictions = forces->impulses.friction_count;
  struct Arena arena = {(uintptr_t)block};
  ARENA_NUMBERS(&arena, n * n, &forces->impulses.delassus);
  ARENA_NUMBERS(&arena, n, &forces->free, &forces->force, &forces->behind, &forces->load);
  ARENA_NUMBERS(&arena, 3 * n, &forces->missing);
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
  size_t contacts = 0, planes = 0, lines = 0;
  for (size_t i = 0; i < switches->contact_count; i++) contacts += resolution->part[i] != LEFT_OUT ? 1 : 0;
  for (size_t i = 0; i < switches->plane_count; i++)
    planes += rest_is_unknown(resolution, switches->planes[i].along) ? 2 : 0;
  for (size_t i = 0; i < switches->friction_count; i++)
    lines += !is_in_plane(switches, i) && rest_is_unknown(resolution, i) ? 1 : 0;
  forces->lines = contacts + planes;
  size_t n = forces->n = contacts + planes + lines, frictions = planes + lines;
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
    if (resolution->part[i] != LEFT_OUT) forces->impulses.member[row++] = i;
  for (size_t i = 0; i < switches->plane_count; i++) {
    size_t along = switches->planes[i].along;
    if (!rest_is_unknown(resolution, along)) continue;
    for (size_t side = 0; side < 2; side++) forces->impulses.member[row++] = along + side;
  }
  for (size_t i = 0; i < switches->friction_count; i++)
    if (!is_in_plane(switches, i) && rest_is_unknown(resolution, i)) forces->impulses.member[row++] = i;
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
    if (resolution->part[i] == LEFT_OUT) continue;
    contact_press(resolution, i, forces->pressure);
    presses = true;
  }
  return !presses || plane_evaluate(resolution);
}

static double limit_of_row(const struct RestForces *forces, size_t row, size_t kind) {
  return forces->resolution->value[friction_slot(forces->resolution->switches, forces->impulses.member[row], kind)];
}

/* Lets the force of a row change by a share of its unit. That of a friction is its kinetic one, against its direction. */
static void set_share(const struct RestForces *forces, size_t row, double share) {
  struct Resolution *resolution = forces->resolution;
  size_t member = forces->impulses.member[row];
  if (row_is_of_contact(forces, row)) contact_press(resolution, member, (1.0 + share) * forces->pressure);
  else if (row_is_of_line(forces, row)) line_release(resolution, member, share);
  else {
    struct PlaneState state = state_of_row(forces, row);
    resolution_set_mode(resolution, state.metadata->slip_direction[member - state.metadata->along], share);
  }
}

/* Returns the force of a row in the last evaluation, with this share. */
static double force_with_share(const struct RestForces *forces, size_t row, double share) {
  if (row_is_of_contact(forces, row)) return (1.0 + share) * forces->pressure;
  return -share * limit_of_row(forces, row, FRICTION_FORCE);
}

/* Returns the acceleration of a row in the last evaluation. */
static double acceleration_of_row(const struct RestForces *forces, size_t row) {
  size_t member = forces->impulses.member[row];
  if (row_is_of_contact(forces, row)) return contact_value(forces->resolution, member, CONTACT_ACCELERATION);
  return forces->resolution->value[friction_slot(forces->resolution->switches, member, FRICTION_RATE)];
}

/*
 * Fills the derivatives by the force of one row. False if accelerations do not exist, or the friction has no force
 * because that of its contact is 0 without frictions.
 */
static bool fill_column(struct RestForces *forces, size_t column) {
  size_t n = forces->n;
  double *acceleration = forces->impulses.delassus + column, *stiction = forces->stiction + column,
         *kinetic = forces->kinetic + column;
  set_share(forces, column, trial_share);
  bool exist = plane_evaluate(forces->resolution);
  double force = exist ? force_with_share(forces, column, trial_share) - force_with_share(forces, column, 0.0) : 0.0;
  for (size_t row = 0; row < n && force != 0.0; row++) {
    acceleration[row * n] = (acceleration_of_row(forces, row) - forces->free[row]) / force;
    if (row_is_of_contact(forces, row)) continue;
    size_t friction = friction_of_row(forces, row);
    stiction[friction * n] = (limit_of_row(forces, row, FRICTION_STICTION) - forces->given_stiction[friction]) / force;
    kinetic[friction * n] = (limit_of_row(forces, row, FRICTION_FORCE) - forces->given_kinetic[friction]) / force;
  }
  set_share(forces, column, 0.0);
  return exist && (force != 0.0 || forces->impulses.contact_count > 0);
}

/* Subtracts the effect of the pressures with which the functions were read. */
static void subtract_pressures(struct RestForces *forces) {
  size_t n = forces->n;
  for (size_t row = 0; row < n; row++)
    for (size_t contact = 0; contact < forces->impulses.contact_count; contact++) {
      forces->free[row] -= forces->pressure * forces->impulses.delassus[row * n + contact];
      if (row_is_of_contact(forces, row)) continue;
      size_t friction = friction_of_row(forces, row);
      forces->given_stiction[friction] -= forces->pressure * forces->stiction[friction * n + contact];
      forces->given_kinetic[friction] -= forces->pressure * forces->kinetic[friction * n + contact];
    }
}

/* Reads the linear functions. False if accelerations do not exist. */
static bool fill_functions(struct RestForces *forces) {
  for (size_t row = forces->impulses.contact_count; row < forces->n; row++) {
    if (!row_is_of_line(forces, row)) {
      struct PlaneState state = state_of_row(forces, row);
      plane_release(forces->resolution, &state);
    }
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
  subtract_pressures(forces);
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

/* Returns the length of the vector of a friction. */
static double length_of(const struct RestForces *forces, size_t row, const double *vector) {
  return row_is_of_line(forces, row) ? fabs(vector[row]) : hypot(vector[row], vector[row + 1]);
}

/* True if the force of a friction is at its limit. */
static bool is_at_limit(const struct RestForces *forces, size_t row) {
  double limit = limit_at(forces, row, forces->impulses.given, forces->impulses.coefficient);
  double rounding = share_at_limit * largest_stiction(forces->resolution),
         response = forces->impulses.delassus[row * (forces->n + 1)];
  double least = (1.0 - least_margin) * limit - rounding - (response > 0.0 ? forces->none / response : 0.0);
  return length_of(forces, row, forces->force) >= least;
}

/* True if a friction that was overcome is at its limit. */
static bool any_has_reached_limit(const struct RestForces *forces) {
  bool any = false;
  for (size_t row = forces->impulses.contact_count; row < forces->n; row += rows_of_friction(forces, row))
    any |=
        *part_of_friction(forces->resolution, forces->impulses.member[row]) == IS_OVERCOME && is_at_limit(forces, row);
  return any;
}

/*
 * Marks the frictions that slip, which have their kinetic limit: those that accelerate, and if one is overcome, all at
 * their limits. Forces that share a load have margins to their limits as long as they hold it. True if a limit falls.
 */
static bool lower_limits(struct RestForces *forces) {
  bool falls = false, is_overcome = any_has_reached_limit(forces);
  for (size_t row = forces->impulses.contact_count; row < forces->n; row += rows_of_friction(forces, row)) {
    bool slips = length_of(forces, row, forces->behind) > forces->none || (is_overcome && is_at_limit(forces, row));
    if (rest_slips(forces, row) || !slips) continue;
    falls |= limit_at(forces, row, forces->given_stiction, forces->stiction) >
             (1.0 + share_at_limit) * limit_at(forces, row, forces->given_kinetic, forces->kinetic);
    for (size_t i = 0; i < rows_of_friction(forces, row); i++) forces->slips[friction_of_row(forces, row) + i] = 1.0;
  }
  return falls;
}

/* Fills the forces of a short step. */
static void take_guess(struct RestForces *forces) {
  size_t contacts = forces->resolution->switches->contact_count;
  for (size_t row = 0; row < forces->n; row++) {
    size_t member = forces->impulses.member[row];
    forces->force[row] = forces->resolution->guess[row_is_of_contact(forces, row) ? member : contacts + member];
  }
}

/* Finds the forces. False if there are none. */
static bool solve_law(struct RestForces *forces) {
  double error;
  if (!fill_functions(forces)) return false;
  if (forces->continues) take_guess(forces);
  do {
    fill_limits(forces);
    bool is_found = (forces->continues ? cone_forces_continue : cone_forces_find)(forces->resolution, &forces->impulses,
                                                                                  forces->free, forces->force, &error);
    if (!is_found) return false;
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
