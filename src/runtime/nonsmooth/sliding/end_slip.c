/*
 * Impacts without collision. Contacts at rest that slide may have no forces (Painleve's paradox). Let a be the
 * accelerations without contact forces. For the rates u + tau a, after a short time tau, the law of cone_search.c does
 * have impulses. As tau vanishes they tend to finite ones, which end the slip. (D. E. Stewart: Rigid-body dynamics with
 * friction and impact, SIAM Review 42, 2000, section 3.) If they tend to 0 there are forces, and nothing is done.
 */
#include "nonsmooth/sliding/end_slip.h"

#include <math.h>

#include "evaluation/services.h"
#include "nonsmooth/cones/cone_impulses.h"
#include "nonsmooth/contacts/contact_impulses.h"
#include "nonsmooth/contacts/impacts.h"
#include "nonsmooth/contacts/planes.h"

/* tau, relative to the time in which the accelerations without contact forces would cause the largest slip. */
static const double short_share = 1e-7;

/* Changes of the rates by less than this multiple of tau a are those of finite forces. */
static const double finite_forces = 20.0;

/* Short steps of an event that may change the velocities. */
enum { SLIP_LIMIT = 100 };

/* A short step. */
struct ShortStep {
  struct Resolution *resolution;
  struct ContactImpulses impulses;
  double *impulse; /* of each row */
  double ahead;    /* largest change of a rate by tau a */
};

/* Selects all contacts that touch, and all frictions. Returns the number of contacts. */
static size_t choose_all_touching(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  size_t count = 0;
  for (size_t i = 0; i < switches->contact_count; i++) {
    bool touches = is_touching(resolution, i);
    resolution->part[i] = touches ? TAKES_PART : LEFT_OUT;
    count += touches ? 1 : 0;
  }
  for (size_t i = 0; i < switches->friction_count; i++) *part_of_friction(resolution, i) = TAKES_PART;
  return count;
}

/* Opens the contacts that touch, and lets all frictions slide. */
static void release_chosen(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->friction_count; i++) set_friction(resolution, i, 1.0);
  for (size_t i = 0; i < switches->contact_count; i++)
    if (resolution->part[i] != LEFT_OUT) set_contact(resolution, i, false);
}

/* Adds the changes of the rates in the time tau. */
static void add_changes_ahead(struct ShortStep *step) {
  const struct Resolution *resolution = step->resolution;
  struct ContactImpulses *impulses = &step->impulses;
  double largest = 0.0, slip = 0.0;
  double *acceleration = step->impulse; /* filled later */
  for (size_t row = 0; row < impulses->count; row++) {
    bool is_contact = row < impulses->contact_count;
    size_t slot = is_contact ? contact_slot(resolution->switches, impulses->member[row], CONTACT_ACCELERATION)
                             : friction_slot(resolution->switches, impulses->member[row], FRICTION_RATE);
    acceleration[row] = resolution->value[slot];
    largest = fmax(largest, fabs(acceleration[row]));
    if (!is_contact) slip = fmax(slip, fabs(impulses->rate[row]));
  }
  double tau = largest > 0.0 ? short_share * slip / largest : 0.0;
  for (size_t row = 0; row < impulses->count; row++) impulses->rate[row] += tau * acceleration[row];
  step->ahead = tau * largest;
}

/* True if impulses of a contact change the rate of another one. */
static bool acts_on_others(const struct ContactImpulses *impulses, size_t row) {
  bool acts = false;
  for (size_t i = 0; i < impulses->contact_count; i++)
    acts |= i != row && impulses->delassus[row * impulses->count + i] != 0.0;
  return acts;
}

/* Returns the change of a contact's rate by its own impulse. */
static double own_change(const struct ShortStep *step, size_t row) {
  return step->impulses.delassus[row * (step->impulses.count + 1)] * step->impulse[row];
}

/* True if some impulse is larger than that of finite forces, and acts on further contacts. */
static bool is_impulsive(const struct ShortStep *step) {
  bool any = false;
  for (size_t row = 0; row < step->impulses.contact_count; row++)
    any |= own_change(step, row) > finite_forces * step->ahead && acts_on_others(&step->impulses, row);
  return any;
}

/* Warns at most once an instance that an impulse has ended a slip; names the contact with the largest one. */
static void report_ended_slip(const struct ShortStep *step) {
  const struct Resolution *resolution = step->resolution;
  size_t most = 0;
  if (resolution->instance->reported_ended_slip) return;
  for (size_t row = 1; row < step->impulses.contact_count; row++)
    if (own_change(step, row) > own_change(step, most)) most = row;
  resolution->instance->reported_ended_slip = true;
  log_message(resolution->instance, STATUS_WARNING,
              "time %g: the forces of contacts that slide, such as '%s', have no solution (Painleve's paradox); an "
              "impulse ends the slip, as it does each further time; expected less friction for finite forces",
              resolution->time, resolution->switches->contacts[step->impulses.member[most]].name);
}

/* Changes the velocities, and opens all contacts. False if the energy would grow, or after too many steps. */
static bool take_impulses(const struct ShortStep *step) {
  struct Resolution *resolution = step->resolution;
  const struct SwitchTable *switches = resolution->switches;
  if (resolution->short_steps++ == SLIP_LIMIT || !is_impulsive(step) || gains_energy(&step->impulses, step->impulse))
    return false;
  report_ended_slip(step);
  for (size_t row = 0; row < step->impulses.count; row++)
    impact_add(resolution, &step->impulses, row, step->impulse[row]);
  for (size_t i = 0; i < switches->contact_count; i++) {
    if (resolution->part[i] != LEFT_OUT) resolution->forced[i] = UNFORCED;
    set_contact(resolution, i, false);
  }
  for (size_t i = 0; i < switches->friction_count; i++) resolution->flips[friction_indicator(switches, i)] = 0.0;
  let_unpressed_slide(resolution);
  resolution->jumped = true;
  resolution->has_found_forces = false;
  resolution->impacts++;
  return let_stopped_slip(resolution);
}

/* Finds the impulses of a step, with the modes of release_chosen(). False if there are none. */
static bool find_impulses_of_step(struct ShortStep *step) {
  add_changes_ahead(step);
  return step->ahead > 0.0 && cone_impulses_find(step->resolution, &step->impulses, step->impulses.rate, step->impulse);
}

/* Takes a step from the modes of release_chosen(), and restores the modes that were kept. */
static bool take_step(struct ShortStep *step) {
  struct Resolution *resolution = step->resolution;
  size_t count = step->impulses.count;
  step->impulse = scratch_take(resolution->instance, SCRATCH_IMPACT, count * sizeof *step->impulse);
  if (step->impulse == NULL) {
    solver_is_out_of_memory(resolution->instance);
    resolution_restore_modes(resolution);
    return false;
  }
  bool is_found = find_impulses_of_step(step);
  resolution_restore_modes(resolution);
  bool is_done = is_found && take_impulses(step);
  scratch_return(resolution->instance, SCRATCH_IMPACT);
  return is_done;
}

bool end_slip(struct Resolution *resolution) {
  struct ShortStep step = {.resolution = resolution};
  bool changed = resolution->changed;
  if (resolution->occasion == AT_START || choose_all_touching(resolution) < 2) return false;
  resolution_keep_modes(resolution);
  release_chosen(resolution);
  bool is_done = resolution_evaluate(resolution) && contact_impulses_create(resolution, &step.impulses);
  if (is_done) {
    is_done = take_step(&step);
    contact_impulses_free(resolution, &step.impulses);
  } else resolution_restore_modes(resolution);
  resolution->changed = changed || is_done;
  return is_done;
}
