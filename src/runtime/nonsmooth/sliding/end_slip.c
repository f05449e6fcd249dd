/*
 * Impacts without collision. Contacts at rest that slide may have no forces (Painleve's paradox). Let a be the
 * accelerations without contact forces. For the rates u + tau a, after a short time tau, the law of cone_search.c does
 * have impulses. As tau vanishes they tend to finite ones, which end the slip. (D. E. Stewart: Rigid-body dynamics with
 * friction and impact, SIAM Review 42, 2000, section 3.)
 *
 * If they tend to 0 there are forces p / tau. From these plane_rests.c finds the modes. A second step counts small rates as 0: of slow frictions, and of lost bounces.
 *
 * Impulses that only stress bodies between contacts may have any size. A small compliance makes them small.
 */
#include "nonsmooth/sliding/end_slip.h"

#include <math.h>
#include <string.h>

#include "evaluation/services.h"
#include "nonsmooth/cones/cone_impulses.h"
#include "nonsmooth/contacts/contact_impulses.h"
#include "nonsmooth/contacts/impact_sequence.h"
#include "nonsmooth/contacts/impacts.h"
#include "nonsmooth/contacts/planes.h"

/*
 * tau, relative to the time in which the accelerations without contact forces would cause the largest slip. Longer times
 * are tried if no impulses are found for the shortest, whose effect is close to rounding, and their impulses continued.
 */
static const double short_shares[] = {1e-7, 1e-5, 1e-3};
enum { SHARES = sizeof short_shares / sizeof *short_shares };

/*
 * Factor of a second, longer step. The impulses of finite forces grow by this factor, those of an impact do not grow.
 * The least growth of the former is the geometric mean of the factor and 1.
 */
static const double longer_by = 10.0, least_growth = 3.1622776601683795;

/* In units of tau a: larger changes of rates by the impulse of a contact may come from a stress. */
static const double largest_stress = 10.0;

/* Relative change of the diagonal elements of W by compliant contacts. */
static const double compliance = 1e-6;

/* Slips that an event ends, and times that it takes the modes of a step. More of them have no end. */
enum { SLIP_LIMIT = 100, MODES_LIMIT = 20 };

/* A short step. */
struct ShortStep {
  struct Resolution *resolution;
  struct ContactImpulses impulses;
  double *impulse, *longer, *work; /* of each row; those of a longer step; workspace */
  double share, tau, ahead;        /* of short_shares[]; in s; largest change of a rate by tau a */
  double slip;                     /* the largest before the step */
  bool has_forces;                 /* there are finite forces, kept in guess[] of the event resolution */
};

/* Opens the contacts that touch, and lets all frictions slide. */
static void release_chosen(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->friction_count; i++) set_friction(resolution, i, 1.0);
  for (size_t i = 0; i < switches->contact_count; i++)
    if (resolution->part[i] != LEFT_OUT) set_contact(resolution, i, false);
}

/* True if the rate of a row is small, and counts as 0. */
static bool has_stopped(const struct ShortStep *step, size_t row) {
  const struct Resolution *resolution = step->resolution;
  size_t member = step->impulses.member[row];
  bool is_contact = row < step->impulses.contact_count;
  return (is_contact ? resolution->part[member] : *part_of_friction(resolution, member)) == IS_SLOW;
}

/* Fills the rates after the time tau, given its share. */
static void fill_rates_ahead(struct ShortStep *step, double share) {
  const struct Resolution *resolution = step->resolution;
  struct ContactImpulses *impulses = &step->impulses;
  double largest = 0.0;
  double *acceleration = step->work;
  step->slip = 0.0;
  for (size_t row = 0; row < impulses->count; row++) {
    impulses->rate[row] = resolution->value[rate_slot(resolution->switches, impulses, row)];
    acceleration[row] = resolution->value[change_slot(resolution->switches, impulses, row)];
    largest = fmax(largest, fabs(acceleration[row]));
    if (row >= impulses->contact_count) step->slip = fmax(step->slip, fabs(impulses->rate[row]));
    if (has_stopped(step, row)) impulses->rate[row] = 0.0;
  }
  step->share = share;
  step->tau = largest > 0.0 ? share * step->slip / largest : 0.0;
  for (size_t row = 0; row < impulses->count; row++) impulses->rate[row] += step->tau * acceleration[row];
  step->ahead = step->tau * largest;
}

/* True if impulses of a contact change the rate of another one. */
static bool acts_on_others(const struct ContactImpulses *impulses, size_t row) {
  bool acts = false;
  for (size_t i = 0; i < impulses->contact_count; i++)
    acts |= i != row && impulses->delassus[row * impulses->count + i] != 0.0;
  return acts;
}

/* Returns the change of a contact's rate by its own impulse. */
static double own_change(const struct ContactImpulses *impulses, const double *impulse, size_t row) {
  return impulses->delassus[row * (impulses->count + 1)] * impulse[row];
}

/* Returns the contact with the largest such change. */
static size_t find_most(const struct ContactImpulses *impulses, const double *impulse) {
  size_t most = 0;
  for (size_t row = 1; row < impulses->contact_count; row++)
    if (own_change(impulses, impulse, row) > own_change(impulses, impulse, most)) most = row;
  return most;
}

/* Returns the largest change of a rate by impulses. */
static double largest_change(const struct ContactImpulses *impulses, const double *impulse) {
  double largest = 0.0;
  for (size_t row = 0; row < impulses->count; row++)
    largest = fmax(largest, fabs(change_of_rate(impulses, impulse, row)));
  return largest;
}

/* Finds the impulses of a step that is longer by longer_by. False if there are none. */
static bool find_longer(struct ShortStep *step) {
  const struct Resolution *resolution = step->resolution;
  struct ContactImpulses *impulses = &step->impulses;
  double share = step->share;
  fill_rates_ahead(step, longer_by * share);
  memcpy(step->longer, step->impulse, impulses->count * sizeof *step->impulse);
  bool is_found = cone_impulses_continue(resolution, impulses, impulses->rate, step->longer) ||
                  cone_impulses_find(resolution, impulses, impulses->rate, step->longer);
  fill_rates_ahead(step, share);
  return is_found;
}

/* True if several contacts have impulses that do not grow with tau: one acts on further contacts, or there are more. */
static bool are_of_several(const struct ShortStep *step) {
  const struct ContactImpulses *impulses = &step->impulses;
  bool acts = false;
  size_t count = 0;
  for (size_t row = 0; row < impulses->contact_count; row++) {
    bool is_small = own_change(impulses, step->impulse, row) <= step->ahead;
    if (is_small || step->longer[row] > least_growth * step->impulse[row]) continue;
    acts |= acts_on_others(impulses, row);
    count++;
  }
  return acts || count > 1;
}

/*
 * True if the impulses of several contacts change rates by more than finite forces do, whose impulses grow with tau.
 * Impulses that only stress bodies between contacts change none.
 */
static bool is_impulsive(struct ShortStep *step) {
  if (!find_longer(step)) return false;
  double change = largest_change(&step->impulses, step->impulse);
  if (!(change > step->ahead) || largest_change(&step->impulses, step->longer) > least_growth * change) return false;
  return are_of_several(step);
}

/*
 * Warns at most once an instance that an impulse has ended a slip beyond the errors of rest; names the contact with the
 * largest one.
 */
static void report_ended_slip(const struct ShortStep *step) {
  const struct Resolution *resolution = step->resolution;
  if (resolution->instance->reported_ended_slip || step->slip <= resolution->tolerances.rest) return;
  size_t most = find_most(&step->impulses, step->impulse);
  resolution->instance->reported_ended_slip = true;
  log_message(resolution->instance, STATUS_WARNING,
              "time %g: the forces of contacts that slide, such as '%s', have no solution (Painleve's paradox); an "
              "impulse ends the slip, as it does each further time; expected less friction for finite forces",
              resolution->time, resolution->switches->contacts[step->impulses.member[most]].name);
}

/* Continues the impulses of a longer time to the shortest; keeps them if that fails. */
static void continue_impulses(struct ShortStep *step, double share) {
  size_t size = step->impulses.count * sizeof *step->impulse;
  fill_rates_ahead(step, short_shares[0]);
  memcpy(step->work, step->impulse, size);
  if (cone_impulses_continue(step->resolution, &step->impulses, step->impulses.rate, step->impulse)) return;
  memcpy(step->impulse, step->work, size);
  fill_rates_ahead(step, share);
}

/*
 * Replaces the impulses by smaller ones, if these exist. A body between contacts may be under self-stress, whose size is
 * not determined. Compliant contacts have the least one; Newton's method continues it to rigid contacts.
 */
static void take_least_stress(struct ShortStep *step) {
  const struct Resolution *resolution = step->resolution;
  struct ContactImpulses *impulses = &step->impulses;
  double *diagonal = step->work;
  size_t most = find_most(impulses, step->impulse);
  double largest = own_change(impulses, step->impulse, most);
  if (!(largest > largest_stress * step->ahead)) return;
  for (size_t row = 0; row < impulses->count; row++) {
    diagonal[row] = impulses->delassus[row * (impulses->count + 1)];
    impulses->delassus[row * (impulses->count + 1)] *= 1.0 + compliance;
  }
  bool is_found = cone_impulses_find(resolution, impulses, impulses->rate, step->longer);
  for (size_t row = 0; row < impulses->count; row++) impulses->delassus[row * (impulses->count + 1)] = diagonal[row];
  is_found = is_found && cone_impulses_continue(resolution, impulses, impulses->rate, step->longer);
  if (is_found && own_change(impulses, step->longer, find_most(impulses, step->longer)) < largest)
    memcpy(step->impulse, step->longer, impulses->count * sizeof *step->impulse);
}

/* Finds the impulses of a step, with the modes of release_chosen(). False if there are none. */
static bool find_impulses_of_step(struct ShortStep *step) {
  bool is_found = false;
  for (int i = 0; i < SHARES && !is_found; i++) {
    fill_rates_ahead(step, short_shares[i]);
    is_found =
        step->ahead > 0.0 && cone_impulses_find(step->resolution, &step->impulses, step->impulses.rate, step->impulse);
    if (is_found && i > 0) continue_impulses(step, short_shares[i]);
  }
  if (is_found) take_least_stress(step);
  return is_found;
}

/* Keeps the forces that have the impulses of a step. */
static void keep_forces(struct ShortStep *step) {
  struct Resolution *resolution = step->resolution;
  const struct ContactImpulses *impulses = &step->impulses;
  size_t contacts = resolution->switches->contact_count;
  memset(resolution->guess, 0, (contacts + resolution->switches->friction_count) * sizeof *resolution->guess);
  for (size_t row = 0; row < impulses->count; row++) {
    size_t member = impulses->member[row];
    resolution->guess[row < impulses->contact_count ? member : contacts + member] = step->impulse[row] / step->tau;
  }
  step->has_forces = true;
}

/* Changes the velocities by a step from the modes of release_chosen(). False if no slip ends, or the energy would grow. */
static bool take_step(struct ShortStep *step) {
  struct Resolution *resolution = step->resolution;
  size_t count = step->impulses.count;
  step->impulse = scratch_take(resolution->instance, SCRATCH_IMPACT, 3 * count * sizeof *step->impulse);
  if (step->impulse == NULL) {
    solver_is_out_of_memory(resolution->instance);
    return false;
  }
  step->work = step->impulse + count;
  step->longer = step->work + count;
  bool is_found = find_impulses_of_step(step), is_impact = is_found && is_impulsive(step);
  if (is_found && !is_impact) keep_forces(step);
  bool is_done = is_impact && !gains_energy(&step->impulses, step->impulse);
  if (is_done) report_ended_slip(step);
  for (size_t row = 0; row < count && is_done; row++) impact_add(resolution, &step->impulses, row, step->impulse[row]);
  scratch_return(resolution->instance, SCRATCH_IMPACT);
  return is_done;
}

static void set_flips(struct Resolution *resolution, double flips) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->friction_count; i++) resolution->flips[friction_indicator(switches, i)] = flips;
}

/* Lets all contacts and frictions find their modes anew behind a step. */
static bool begin_anew(struct Resolution *resolution) {
  for (size_t i = 0; i < resolution->switches->contact_count; i++)
    if (resolution->part[i] != LEFT_OUT) resolution->forced[i] = UNFORCED;
  set_flips(resolution, 0.0);
  resolution->has_found_forces = false;
  resolution->ended_slips++;
  impact_leave_open(resolution);
  return let_stopped_slip(resolution);
}

/* Marks those that take part and have small rates: contacts whose bounces are lost, and slow frictions. */
static void mark_slow(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->contact_count; i++)
    if (resolution->part[i] != LEFT_OUT && contact_may_rest(resolution, i)) resolution->part[i] = IS_SLOW;
  for (size_t i = 0; i < switches->friction_count; i++)
    if (is_in_plane(switches, i) && switches->friction_laws->is_slow(resolution, plane_of(switches, i)))
      *part_of_friction(resolution, i) = IS_SLOW;
}

/* Evaluates with the present modes; with those of release_chosen() if they have no accelerations. False without any. */
static bool evaluate_or_release(struct Resolution *resolution) {
  if (resolution_evaluate(resolution)) return true;
  release_chosen(resolution);
  return resolution_evaluate(resolution);
}

/* Finds the modes from the forces of a step. False if there are none, or after many steps in the event. */
static bool continue_forces(struct Resolution *resolution, bool stops) {
  if (!evaluate_or_release(resolution)) return false;
  if (++resolution->continued_forces > MODES_LIMIT) return false;
  if (!resolution->switches->friction_laws->continue_together(resolution, stops)) return false;
  set_flips(resolution, 1.0);
  return true;
}

/* Ends a slip by a step, or finds the modes from its forces. stops: small rates count as 0. False if that fails. */
static bool end_slip_by_step(struct Resolution *resolution, bool stops) {
  struct ShortStep step = {.resolution = resolution};
  bool changed = resolution->changed, is_done = false;
  if (stops && !resolution_evaluate(resolution)) return false; /* accelerations decide on what is slow */
  if (choose_touching(resolution, TAKES_PART) < 2) return false;
  if (stops) mark_slow(resolution);
  resolution_keep_modes(resolution);
  release_chosen(resolution);
  if (resolution_evaluate(resolution) && contact_impulses_create(resolution, &step.impulses)) {
    is_done = take_step(&step);
    contact_impulses_free(resolution, &step.impulses);
  }
  resolution_restore_modes(resolution);
  resolution->changed = changed || is_done;
  if (is_done) return begin_anew(resolution);
  return step.has_forces && continue_forces(resolution, stops);
}

bool end_slip(struct Resolution *resolution) {
  if (resolution->occasion == AT_START || resolution->ended_slips == SLIP_LIMIT) return false;
  return end_slip_by_step(resolution, false) || end_slip_by_step(resolution, true);
}
