/*
 * Moreau's time stepping (J. J. Moreau: Numerical aspects of the sweeping process, Comput. Methods Appl. Mech. Eng. 177,
 * 1999), with the gaps of D. E. Stewart and J. C. Trinkle (Int. J. Numer. Methods Eng. 39, 1996). In a step h all contacts
 * and frictions together have the impulses p. With the accelerations a without them,
 *
 *   v' = v + h a + M^-1 J^T p,   q' = q + h q_dot(q, v'),
 *
 * where p and the rates u' = J v' fulfil the law of cone_search.c. A contact whose gap would close is struck, and has
 * the rate -e u' behind. Of the others the gap may not close: their rates are u' + gap / h. So the step needs no modes, and
 * passes any number of events.
 */
#include "time_steps/time_step.h"

#include <math.h>

#include "evaluation/evaluate.h"
#include "evaluation/services.h"
#include "nonsmooth/cones/cone_impulses.h"
#include "nonsmooth/contacts/contact_impulses.h"
#include "nonsmooth/contacts/impacts.h"
#include "nonsmooth/tolerances.h"

/* Contacts take part whose gap could close in this many steps. */
static const double reach = 4.0;

/* Relative to the limit: a friction with a smaller impulse sticks. */
static const double below_limit = 1e-9;

void release_contacts(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->contact_count; i++) set_contact(resolution, i, false);
  for (size_t i = 0; i < switches->friction_count; i++)
    for (size_t k = 0; k < switches->contact_count; k++)
      if (rests_on(switches, i, k)) set_friction(resolution, i, 1.0);
}

/* Selects the contacts that the step may close, with their frictions. Returns their number. */
static size_t choose_near(struct Resolution *resolution, double length) {
  const struct SwitchTable *switches = resolution->switches;
  double fastest = 0.0;
  size_t count = 0;
  for (size_t i = 0; i < switches->contact_count; i++)
    fastest = fmax(fastest, fabs(contact_value(resolution, i, CONTACT_RATE)) +
                                length * fabs(contact_value(resolution, i, CONTACT_ACCELERATION)));
  for (size_t i = 0; i < switches->contact_count; i++) {
    bool is_near = contact_value(resolution, i, CONTACT_GAP) <= reach * length * fastest;
    resolution->part[i] = is_near ? TAKES_PART : LEFT_OUT;
    count += is_near ? 1 : 0;
  }
  for (size_t i = 0; i < switches->friction_count; i++) *part_of_friction(resolution, i) = TAKES_PART;
  return count;
}

/* Fills the rates at the end of the step without impulses. */
static void fill_rates(const struct Resolution *resolution, const struct ContactImpulses *impulses, double length) {
  for (size_t row = 0; row < impulses->count; row++) {
    double change = resolution->value[change_slot(resolution->switches, impulses, row)];
    impulses->rate[row] = resolution->value[rate_slot(resolution->switches, impulses, row)] + length * change;
  }
}

/* Adds to the rates of contacts what they may not fall to: minus that of a bounce, or of a gap that closes. */
static void add_bounds(const struct Resolution *resolution, const struct ContactImpulses *impulses, double length,
                       bool bounces) {
  for (size_t row = 0; row < impulses->contact_count; row++) {
    size_t contact = impulses->member[row];
    double gap = fmax(contact_value(resolution, contact, CONTACT_GAP), 0.0);
    bool is_struck = gap + length * impulses->rate[row] < 0.0;
    double restitution = is_struck && bounces ? impact_restitution(resolution, contact) : 0.0;
    double closing = fmin(contact_value(resolution, contact, CONTACT_RATE), 0.0);
    impulses->rate[row] += is_struck ? restitution * closing : gap / length;
  }
}

/* Finds the impulses. False if there are none, or energy would grow, as with much friction at a bounce. */
static bool find_impulses_ahead(const struct Resolution *resolution, const struct ContactImpulses *impulses,
                                double length, bool bounces, double *impulse) {
  fill_rates(resolution, impulses, length);
  add_bounds(resolution, impulses, length, bounces);
  if (!cone_impulses_find(resolution, impulses, impulses->rate, impulse)) return false;
  fill_rates(resolution, impulses, length);
  return !gains_energy(impulses, impulse);
}

/*
 * Closes the contacts that have an impulse and do not bounce, and lets the frictions stick that are below their limits.
 */
static void set_modes(struct Resolution *resolution, const struct ContactImpulses *impulses, const double *impulse) {
  size_t contacts = impulses->contact_count;
  double slow = tolerances_of(resolution).rest;
  for (size_t row = 0; row < contacts; row++) {
    bool bounces = impulses->rate[row] + change_of_rate(impulses, impulse, row) > slow;
    if (impulse[row] > 0.0 && !bounces) set_contact(resolution, impulses->member[row], true);
  }
  for (size_t row = contacts; row < impulses->count; row++) {
    size_t friction = impulses->member[row], rows = is_in_plane(resolution->switches, friction) ? 2 : 1;
    double size = rows == 2 ? hypot(impulse[row], impulse[row + 1]) : fabs(impulse[row]);
    if (size < (1.0 - below_limit) * limit_with(impulses, impulse, row)) set_friction(resolution, friction, 0.0);
    row += rows - 1;
  }
  let_unpressed_slide(resolution);
}

/* Moves the coordinates, and the states of the first order, with the velocities. False if rates do not exist. */
static bool move_coordinates(struct Resolution *resolution, double length) {
  double *rate = resolution->rounded;
  size_t n = lagrangian.coordinate_count;
  if (!solver_derivatives(resolution->instance, resolution->time, resolution->state, rate)) return false;
  for (size_t i = 0; i < lagrangian.state_count; i++)
    if (i < n || i >= 2 * n) resolution->state[i] += length * rate[i];
  resolution->time += length;
  return true;
}

/*
 * Adds the accelerations and impulses of a step, and moves on. False if there are no impulses. Where restitution would
 * add energy, nothing bounces.
 */
static bool take_impulses(struct Resolution *resolution, const struct ContactImpulses *impulses, double length,
                          double *impulse) {
  const double *acceleration = resolution_accelerations(resolution);
  double *velocity = resolution->state + lagrangian.coordinate_count;
  if (!find_impulses_ahead(resolution, impulses, length, true, impulse) &&
      !find_impulses_ahead(resolution, impulses, length, false, impulse))
    return false;
  for (size_t i = 0; i < lagrangian.coordinate_count; i++) velocity[i] += length * acceleration[i];
  for (size_t row = 0; row < impulses->count; row++) impact_add(resolution, impulses, row, impulse[row]);
  if (!move_coordinates(resolution, length)) return false;
  set_modes(resolution, impulses, impulse);
  return true;
}

/* Returns the time in which the accelerations change positions by the tolerance. */
static double longest_time_step(const struct Resolution *resolution) {
  const double *acceleration = resolution_accelerations(resolution);
  double longest = INFINITY;
  for (size_t i = 0; i < lagrangian.coordinate_count; i++) {
    double change = solver_tolerance(resolution->instance) * scale_of(resolution->state, i);
    longest = fmin(longest, sqrt(change / fabs(acceleration[i])));
  }
  return longest;
}

/* Takes a step from the modes of release_contacts(). False if it has no impulses. */
static bool take_free_step(struct Resolution *resolution, double length) {
  struct ContactImpulses impulses;
  if (choose_near(resolution, length) < 2) return false; /* the events of a single contact can be found */
  if (!contact_impulses_create(resolution, &impulses)) return false;
  double *impulse = scratch_take(resolution->instance, SCRATCH_IMPACT, impulses.count * sizeof *impulse);
  bool is_done = impulse != NULL && take_impulses(resolution, &impulses, length, impulse);
  if (impulse == NULL) solver_is_out_of_memory(resolution->instance);
  else scratch_return(resolution->instance, SCRATCH_IMPACT);
  contact_impulses_free(resolution, &impulses);
  return is_done;
}

double time_step(struct Resolution *resolution, double share, double limit, double *longest) {
  resolution_keep_modes(resolution);
  release_contacts(resolution);
  if (resolution_evaluate(resolution)) {
    *longest = longest_time_step(resolution);
    double length = fmin(share * *longest, limit);
    if (take_free_step(resolution, length)) return length;
  }
  resolution_restore_modes(resolution);
  return 0.0;
}
