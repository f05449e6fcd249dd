/*
 * Impulses of an impact, by Newton's law of restitution and Coulomb's law. The impulse p of each contact that is hit,
 * and the rates of its gap before (u-) and after the impact (u+), fulfil
 *
 *   p >= 0,   u+ + e u- >= 0,   p (u+ + e u-) = 0.
 *
 * The impulse of a friction is within the limit mu p. If it slides after the impact, the impulse is at the limit
 * and against the velocity; else it is what sticking requires. cone_search.c finds these impulses.
 *
 * Without restitution there is a solution, and it gains no energy. With e it may gain some (Kane's paradox); then all
 * restitutions are multiplied by the largest factor, found by bisection, that gains none. If no impulses are found, the
 * step ends with a message.
 */
#include "nonsmooth/contacts/impacts.h"

#include <float.h>
#include <math.h>

#include "nonsmooth/cones/cone_impulses.h"
#include "nonsmooth/contacts/contact_forces.h"
#include "nonsmooth/contacts/contact_impulses.h"
#include "evaluation/services.h"

/* Bisections of the factor of the restitutions, to 2^-52. */
enum { HALVINGS = 52 };

/* The impulses of an impact, of each contact, then each friction. */
struct Impact {
  const struct ContactImpulses *impulses;
  double *rate; /* before the impact, of contacts times 1 + share e */
  double *impulse;
};

double impact_restitution(const struct Resolution *resolution, size_t contact) {
  double restitution = contact_value(resolution, contact, CONTACT_RESTITUTION);
  double rate = -restitution * contact_value(resolution, contact, CONTACT_RATE);
  return bounce_is_lost(resolution, contact, rate) ? 0.0 : restitution;
}

/* Returns the factor of a rate before the impact in its complementarity condition: 1 + share e if the gap closes. */
static double rise_by_restitution(const struct Resolution *resolution, const struct ContactImpulses *impulses,
                                  size_t push, double share) {
  double bounce = push < impulses->contact_count ? impact_restitution(resolution, impulses->member[push]) : 0.0;
  return 1.0 + (impulses->rate[push] < 0.0 ? share * bounce : 0.0);
}

/* Finds the impulses with a factor of the restitutions. False if none are found. */
static bool find_impulses(const struct Resolution *resolution, const struct Impact *impact, double share) {
  const struct ContactImpulses *impulses = impact->impulses;
  for (size_t i = 0; i < impulses->count; i++)
    impact->rate[i] = impulses->rate[i] * rise_by_restitution(resolution, impulses, i, share);
  return cone_impulses_find(resolution, impulses, impact->rate, impact->impulse);
}

static bool is_fine(const struct Resolution *resolution, const struct Impact *impact, double share) {
  return find_impulses(resolution, impact, share) && !gains_energy(impact->impulses, impact->impulse);
}

/* Finds the impulses with the largest factor of the restitutions that gains no energy, by bisection. */
static bool find_fine_impulses(const struct Resolution *resolution, const struct Impact *impact, bool bounces) {
  if (!bounces) return find_impulses(resolution, impact, 0.0);
  if (is_fine(resolution, impact, 1.0)) return true;
  double fine = 0.0, too_much = 1.0;
  for (int i = 0; i < HALVINGS; i++) {
    double middle = 0.5 * (fine + too_much);
    if (is_fine(resolution, impact, middle)) fine = middle;
    else too_much = middle;
  }
  return find_impulses(resolution, impact, fine);
}

void impact_add(struct Resolution *resolution, const struct ContactImpulses *impulses, size_t row, double impulse) {
  double *velocity = resolution->state + lagrangian.coordinate_count;
  if (row < impulses->contact_count && impulse > 0.0) resolution->struck[impulses->member[row]] = 1.0;
  for (size_t k = 0; k < lagrangian.coordinate_count; k++)
    velocity[k] += impulse * impulses->velocities[row * lagrangian.coordinate_count + k];
}

static void add_impulses(struct Resolution *resolution, const struct ContactImpulses *impulses, const double *impulse) {
  for (size_t row = 0; row < impulses->count; row++) impact_add(resolution, impulses, row, impulse[row]);
}

/* Applies the impulse of one contact without friction: p = max(-(1 + e) u- / W, 0). */
static bool take_one(struct Resolution *resolution, const struct ContactImpulses *impulses, bool bounces) {
  double bounce = bounces ? impact_restitution(resolution, impulses->member[0]) : 0.0;
  double impulse = fmax(-(1.0 + bounce) * impulses->rate[0] / impulses->delassus[0], 0.0);
  if (!(impulses->delassus[0] > DBL_MIN)) {
    contact_forces_report_fixed(resolution, impulses->member[0]);
    return false;
  }
  add_impulses(resolution, impulses, &impulse);
  return true;
}

/* Returns the first contact whose gap no impulse changes; their number if there is none. */
static size_t find_fixed(const struct ContactImpulses *impulses) {
  size_t row = 0;
  while (row < impulses->contact_count && impulses->delassus[row * impulses->count + row] > DBL_MIN) row++;
  return row;
}

/* Returns the contact that closes fastest. */
static size_t find_fastest(const struct ContactImpulses *impulses) {
  size_t fastest = 0;
  for (size_t i = 1; i < impulses->contact_count; i++)
    if (impulses->rate[i] < impulses->rate[fastest]) fastest = i;
  return impulses->member[fastest];
}

/* True if no impulses of the contacts alone, without friction, keep the gaps from closing. */
static bool are_crushed(const struct Resolution *resolution, const struct ContactImpulses *impulses) {
  double *impulse = scratch_take(resolution->instance, SCRATCH_IMPACT, impulses->count * sizeof *impulse);
  bool is_found = impulse == NULL || cone_impulses_find(resolution, impulses, impulses->rate, impulse);
  if (impulse != NULL) scratch_return(resolution->instance, SCRATCH_IMPACT);
  return !is_found;
}

/* Logs why the contacts that take part have no impulses. */
static void report_impact(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  struct ContactImpulses impulses;
  for (size_t i = 0; i < switches->friction_count; i++) *part_of_friction(resolution, i) = LEFT_OUT;
  if (!contact_impulses_create(resolution, &impulses)) return;
  size_t row = find_fixed(&impulses), fastest = find_fastest(&impulses);
  bool is_fixed = row < impulses.contact_count, is_crushed = !is_fixed && are_crushed(resolution, &impulses);
  if (is_fixed) contact_forces_report_fixed(resolution, impulses.member[row]);
  contact_impulses_free(resolution, &impulses);
  if (is_crushed) contact_forces_report_crushed(resolution, fastest);
  else if (!is_fixed)
    log_message(resolution->instance, STATUS_DISCARD,
                "time %g: no impulses were found for an impact of the contact '%s'; expected less friction, or another "
                "position",
                resolution->time, switches->contacts[fastest].name);
}

/* True if all rates are those of rest: the impact is a rounding error. */
static bool is_hit_at_rest(const struct Resolution *resolution, const struct ContactImpulses *impulses) {
  double fastest = 0.0;
  for (size_t i = 0; i < impulses->count; i++) fastest = fmax(fastest, fabs(impulses->rate[i]));
  return fastest <= resolution->tolerances.rest;
}

/* Warns at most once an instance that the impact has several outcomes. */
static void report_other_outcomes(const struct Resolution *resolution, const struct Impact *impact) {
  const struct ContactImpulses *impulses = impact->impulses;
  const struct SwitchTable *switches = resolution->switches;
  if (impulses->friction_count == 0 || resolution->instance->reported_other_impulses) return;
  if (is_hit_at_rest(resolution, impulses)) return;
  if (!cone_impulses_have_others(resolution, impulses, impact->rate, impact->impulse)) return;
  resolution->instance->reported_other_impulses = true;
  log_message(resolution->instance, STATUS_WARNING,
              "time %g: an impact, such as of the contact '%s' with the friction '%s', has more than one solution; one "
              "of them is taken",
              resolution->time, switches->contacts[impulses->member[0]].name,
              switches->frictions[impulses->member[impulses->contact_count]].name);
}

static bool take_several(struct Resolution *resolution, const struct ContactImpulses *impulses, bool bounces) {
  double *block = scratch_take(resolution->instance, SCRATCH_IMPACT, 2 * impulses->count * sizeof *block);
  struct Impact impact = {.impulses = impulses, .rate = block, .impulse = block + impulses->count};
  if (block == NULL) {
    solver_is_out_of_memory(resolution->instance);
    return false;
  }
  bool is_done = find_fine_impulses(resolution, &impact, bounces);
  if (is_done) {
    report_other_outcomes(resolution, &impact);
    add_impulses(resolution, impulses, impact.impulse);
  }
  scratch_return(resolution->instance, SCRATCH_IMPACT);
  return is_done;
}

bool impacts_take(struct Resolution *resolution, bool bounces) {
  struct ContactImpulses impulses;
  if (!contact_impulses_create(resolution, &impulses)) return false;
  bool is_done =
      impulses.count == 1 ? take_one(resolution, &impulses, bounces) : take_several(resolution, &impulses, bounces);
  bool is_single = impulses.count == 1; /* its only reason to fail has been logged */
  contact_impulses_free(resolution, &impulses);
  if (!is_done && !is_single) report_impact(resolution);
  resolution->changed = true;
  return is_done;
}
