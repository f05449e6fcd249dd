/*
 * Impulses of an impact, by Newton's law of restitution and Coulomb's law. The impulse p of each contact that is hit,
 * and the rates of its gap before (u-) and after the impact (u+), fulfil
 *
 *   p >= 0,   u+ + e u- >= 0,   p (u+ + e u-) = 0.
 *
 * The impulse of a friction is within the limit mu p. If it slides after the impact, the impulse is at the limit
 * and against the velocity; else it is what sticking requires. Frictions along lines are split into impulses along
 * and against the velocity, with the sliding speed as a slack. This gives one linear complementarity problem
 * (Anitescu and Potra, Nonlinear Dynamics 14, 1997), which Lemke's method solves. It is regularized and iterated by
 * the proximal point method, so that impulses that are not unique stay small. Frictions in planes have cones, and
 * need find_impulses of struct FrictionLaws instead (nonsmooth/planes/cone_impulses.c).
 *
 * Without restitution there is a solution, and it gains no energy. With e it may gain some (Kane's paradox); then all
 * restitutions are multiplied by the largest factor, found by bisection, that gains none. If no impulses are found, the
 * step ends with a message.
 */
#include "nonsmooth/contacts/impacts.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "nonsmooth/contacts/complementarity.h"
#include "nonsmooth/contacts/contact_forces.h"
#include "nonsmooth/contacts/planes.h"
#include "nonsmooth/tolerances.h"
#include "nonsmooth/contacts/contact_impulses.h"
#include "evaluation/evaluate.h"
#include "evaluation/services.h"
#include "support/arena.h"

/* HALVINGS: bisections of the factor of the restitutions, to 2^-52. SOLUTIONS: iterations of the proximal method. */
enum { HALVINGS = 52, SOLUTIONS = 50 };

/* Energy gains below this fraction of the terms of the work are rounding errors. */
static const double least_gain = 1e-13;

/*
 * Two outcomes differ if the difference of their impulses, applied at rest, makes more than this fraction of their
 * energies.
 */
static const double differing_share = 1e-8;

/* Proximal terms, added to the diagonal of the scaled Delassus matrix, in the order in which they are tried. */
static const double regularizations[] = {1e-8, 1e-6};

/* Relative residuals: above impulses_hold, the next proximal term is tried; impulses_roughly_hold is accepted at last. */
static const double impulses_hold = 1e-12, impulses_roughly_hold = 1e-5;

/*
 * The linear complementarity problem, scaled such that W_ii = 1 for each impulse. Rows: impulses of contacts; those of
 * frictions along their velocities; those against them; sliding speeds.
 */
struct ImpactProblem {
  const struct ContactImpulses *impulses;
  size_t count;
  double *unit; /* unit of each impulse: 1 / sqrt(W_ii), 0 if W_ii is 0 */
  double *matrix, *rate, *q, *z, *next, *work;
  double *impulse; /* of each contact, then each friction */
  double share;    /* factor of the restitutions of the last solution */
  void *block;
};

static size_t first_row(const struct ImpactProblem *problem, size_t part) {
  const struct ContactImpulses *impulses = problem->impulses;
  return part == 0 ? 0 : impulses->contact_count + (part - 1) * impulses->friction_count;
}

/* Fills the elements of a pair of impulses; a friction has two rows, along and against its velocity. */
static void fill_delassus(struct ImpactProblem *problem, size_t i, size_t j) {
  const struct ContactImpulses *impulses = problem->impulses;
  size_t contacts = impulses->contact_count, frictions = impulses->friction_count, n = problem->count;
  double value = impulses->delassus[i * impulses->count + j] * problem->unit[i] * problem->unit[j];
  for (size_t side = 0; side < (i < contacts ? 1u : 2u); side++)
    for (size_t other = 0; other < (j < contacts ? 1u : 2u); other++)
      problem->matrix[(i + side * frictions) * n + j + other * frictions] = side == other ? value : -value;
}

static void fill_friction(struct ImpactProblem *problem, size_t friction) {
  const struct ContactImpulses *impulses = problem->impulses;
  size_t n = problem->count, contacts = impulses->contact_count;
  size_t along = first_row(problem, 1) + friction, against = first_row(problem, 2) + friction,
         slides = first_row(problem, 3) + friction;
  double unit = problem->unit[contacts + friction];
  problem->matrix[along * n + slides] = problem->matrix[against * n + slides] = 1.0;
  problem->matrix[slides * n + along] = problem->matrix[slides * n + against] = -1.0;
  for (size_t i = 0; i < contacts && unit > 0.0; i++)
    problem->matrix[slides * n + i] = impulses->coefficient[friction * contacts + i] * problem->unit[i] / unit;
}

static size_t lay_out_problem(struct ImpactProblem *problem, void *block) {
  size_t n = problem->count;
  struct Arena arena = {(uintptr_t)block};
  ARENA_NUMBERS(&arena, problem->impulses->count, &problem->unit, &problem->impulse);
  ARENA_NUMBERS(&arena, n * n, &problem->matrix);
  ARENA_NUMBERS(&arena, n, &problem->rate, &problem->q, &problem->z, &problem->next);
  ARENA_NUMBERS(&arena, complementarity_work_count(n), &problem->work);
  return arena.next - (uintptr_t)block;
}

/* Sets up the matrix. False if a contact cannot be moved, or memory is missing. */
static bool create_problem(struct Resolution *resolution, const struct ContactImpulses *impulses,
                           struct ImpactProblem *problem) {
  size_t n = impulses->contact_count + 3 * impulses->friction_count, count = impulses->count;
  *problem = (struct ImpactProblem){.impulses = impulses, .count = n};
  problem->block = scratch_take(resolution->instance, SCRATCH_IMPACT, lay_out_problem(problem, NULL));
  if (problem->block == NULL) {
    solver_is_out_of_memory(resolution->instance);
    return false;
  }
  lay_out_problem(problem, problem->block);
  bool moves = true;
  for (size_t i = 0; i < count; i++) {
    double delassus = impulses->delassus[i * count + i];
    problem->unit[i] = delassus > DBL_MIN ? 1.0 / sqrt(delassus) : 0.0;
    moves &= i >= impulses->contact_count || problem->unit[i] > 0.0;
  }
  for (size_t i = 0; i < count; i++)
    for (size_t j = 0; j < count; j++) fill_delassus(problem, i, j);
  for (size_t f = 0; f < impulses->friction_count; f++) fill_friction(problem, f);
  return moves;
}

/*
 * Returns the restitution of a contact; 0 if the bounce would be lost in errors. The friction of a bounce that is cut
 * short is then that of rest, whose impulse equals the sum of all further bounces.
 */
static double restitution_of(const struct Resolution *resolution, size_t contact) {
  double restitution = contact_value(resolution, contact, CONTACT_RESTITUTION);
  double rate = -restitution * contact_value(resolution, contact, CONTACT_RATE);
  return bounce_is_lost(resolution, contact, rate) ? 0.0 : restitution;
}

/* Returns the factor of a rate before the impact in its complementarity condition: 1 + share e if the gap closes. */
static double rise_by_restitution(const struct Resolution *resolution, const struct ContactImpulses *impulses,
                                  size_t push, double share) {
  double bounce = push < impulses->contact_count ? restitution_of(resolution, impulses->member[push]) : 0.0;
  return 1.0 + (impulses->rate[push] < 0.0 ? share * bounce : 0.0);
}

/* Fills the constant terms of the conditions, relative to the largest one. Returns this. */
static double fill_rates(const struct Resolution *resolution, struct ImpactProblem *problem, double share) {
  const struct ContactImpulses *impulses = problem->impulses;
  double largest = 0.0;
  memset(problem->rate, 0, problem->count * sizeof *problem->rate);
  for (size_t i = 0; i < impulses->count; i++) {
    bool is_contact = i < impulses->contact_count;
    double rate = impulses->rate[i] * problem->unit[i] * rise_by_restitution(resolution, impulses, i, share);
    problem->rate[i] = rate;
    if (!is_contact) problem->rate[i + impulses->friction_count] = -rate;
    largest = fmax(largest, fabs(rate));
  }
  for (size_t i = 0; i < problem->count && largest > 0.0; i++) problem->rate[i] /= largest;
  return largest;
}

/* Returns the residual of an iterate without regularization, max |min(z_i, w_i)|, relative to the largest impulse. */
static double relative_residual(const struct ImpactProblem *problem, double regularization) {
  size_t n = problem->count, regular = first_row(problem, 3);
  double residual = 0.0, size = 1.0;
  for (size_t i = 0; i < n; i++) {
    double w = problem->rate[i] - (i < regular ? regularization * problem->next[i] : 0.0);
    for (size_t j = 0; j < n; j++) w += problem->matrix[i * n + j] * problem->next[j];
    residual = fmax(residual, fabs(fmin(w, problem->next[i])));
    size = fmax(size, problem->next[i]);
  }
  return residual / size;
}

/*
 * Makes iterations of the proximal point method: Lemke's method for the matrix plus regularization, with q less
 * regularization times the last iterate. They end when the residual falls no further: rounding errors add up in
 * impulses that are not unique. Stores the best iterate in z, and its residual in *least.
 */
static void iterate_proximal(struct ImpactProblem *problem, double regularization, double *least) {
  size_t n = problem->count, regular = first_row(problem, 3);
  double last = INFINITY;
  bool falls = true;
  memset(problem->next, 0, n * sizeof *problem->next);
  for (size_t i = 0; i < regular; i++) problem->matrix[i * n + i] += regularization;
  for (int count = 0; count < SOLUTIONS && falls; count++) {
    for (size_t i = 0; i < n; i++)
      problem->q[i] = problem->rate[i] - (i < regular ? regularization * problem->next[i] : 0.0);
    bool is_solved = complementarity_solve(n, problem->matrix, problem->q, problem->next, problem->work);
    double residual = is_solved ? relative_residual(problem, regularization) : INFINITY;
    if (residual < *least) memcpy(problem->z, problem->next, n * sizeof *problem->z);
    *least = fmin(*least, residual);
    falls = residual < last && residual > DBL_EPSILON;
    last = residual;
  }
  for (size_t i = 0; i < regular; i++) problem->matrix[i * n + i] -= regularization;
}

/* Returns the row of the first friction that acts in a plane; their number if there is none. */
static size_t find_plane(const struct Resolution *resolution, const struct ContactImpulses *impulses) {
  size_t row = impulses->contact_count;
  while (row < impulses->count && !is_in_plane(resolution->switches, impulses->member[row])) row++;
  return row;
}

/* Fills the constant terms of the conditions, unscaled, for the contacts and frictions. */
static void fill_plain_rates(const struct Resolution *resolution, struct ImpactProblem *problem) {
  const struct ContactImpulses *impulses = problem->impulses;
  for (size_t i = 0; i < impulses->count; i++)
    problem->rate[i] = impulses->rate[i] * rise_by_restitution(resolution, impulses, i, problem->share);
}

/* Finds the impulses with frictions in planes. Their conditions are not linear. */
static bool find_impulses_in_planes(const struct Resolution *resolution, struct ImpactProblem *problem) {
  const struct ContactImpulses *impulses = problem->impulses;
  fill_plain_rates(resolution, problem);
  return resolution->switches->friction_laws->find_impulses(resolution, impulses, problem->rate, problem->impulse);
}

/* Finds the impulses with a factor of the restitutions. False if none are found. */
static bool find_impulses(const struct Resolution *resolution, struct ImpactProblem *problem, double share) {
  const struct ContactImpulses *impulses = problem->impulses;
  problem->share = share;
  if (find_plane(resolution, impulses) < impulses->count) return find_impulses_in_planes(resolution, problem);
  double scale = fill_rates(resolution, problem, share), residual = INFINITY;
  memset(problem->z, 0, problem->count * sizeof *problem->z);
  for (size_t i = 0; i < sizeof regularizations / sizeof *regularizations && residual > impulses_hold; i++)
    iterate_proximal(problem, regularizations[i], &residual);
  for (size_t i = 0; i < impulses->count; i++) {
    double against = i < impulses->contact_count ? 0.0 : problem->z[i + impulses->friction_count];
    problem->impulse[i] = (problem->z[i] - against) * problem->unit[i] * scale;
  }
  return residual <= impulses_roughly_hold;
}

/* True if the work of the impulses is positive beyond rounding. */
static bool gains_energy(const struct ContactImpulses *impulses, const double *impulse) {
  double work = 0.0, size = 0.0;
  for (size_t i = 0; i < impulses->count; i++) {
    double change = 0.0;
    for (size_t j = 0; j < impulses->count; j++) change += impulses->delassus[i * impulses->count + j] * impulse[j];
    work += impulse[i] * (impulses->rate[i] + 0.5 * change);
    size += fabs(impulse[i]) * (fabs(impulses->rate[i]) + 0.5 * fabs(change));
  }
  return work > least_gain * size;
}

/* Returns p^T W p of p = impulse - share other: twice the energy of the motion that p makes from rest. */
static double energy_made(const struct ContactImpulses *impulses, const double *impulse, const double *other,
                          double share) {
  double sum = 0.0;
  for (size_t i = 0; i < impulses->count; i++)
    for (size_t j = 0; j < impulses->count; j++)
      sum += (impulse[i] - share * other[i]) * impulses->delassus[i * impulses->count + j] *
             (impulse[j] - share * other[j]);
  return sum;
}

bool is_other_outcome(const struct ContactImpulses *impulses, const double *impulse, const double *found) {
  double size = energy_made(impulses, impulse, found, 0.0) + energy_made(impulses, found, impulse, 0.0);
  return energy_made(impulses, impulse, found, 1.0) > differing_share * size && !gains_energy(impulses, impulse);
}

static bool is_fine(const struct Resolution *resolution, struct ImpactProblem *problem, double share) {
  return find_impulses(resolution, problem, share) && !gains_energy(problem->impulses, problem->impulse);
}

/* Finds the impulses with the largest factor of the restitutions that gains no energy, by bisection. */
static bool find_fine_impulses(const struct Resolution *resolution, struct ImpactProblem *problem, bool bounces) {
  if (!bounces) return find_impulses(resolution, problem, 0.0);
  if (is_fine(resolution, problem, 1.0)) return true;
  double fine = 0.0, too_much = 1.0;
  for (int i = 0; i < HALVINGS; i++) {
    double middle = 0.5 * (fine + too_much);
    if (is_fine(resolution, problem, middle)) fine = middle;
    else too_much = middle;
  }
  return find_impulses(resolution, problem, fine);
}

static void add_impulses(struct Resolution *resolution, const struct ContactImpulses *impulses, const double *impulse) {
  double *velocity = resolution->state + lagrangian.coordinate_count;
  for (size_t i = 0; i < impulses->contact_count; i++)
    if (impulse[i] > 0.0) resolution->struck[impulses->member[i]] = 1.0;
  for (size_t i = 0; i < impulses->count; i++)
    for (size_t k = 0; k < lagrangian.coordinate_count; k++)
      velocity[k] += impulse[i] * impulses->velocities[i * lagrangian.coordinate_count + k];
}

/* Applies the impulse of one contact without friction: p = max(-(1 + e) u- / W, 0). */
static bool take_one(struct Resolution *resolution, const struct ContactImpulses *impulses, bool bounces) {
  double bounce = bounces ? restitution_of(resolution, impulses->member[0]) : 0.0;
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

static void report_impact(const struct Resolution *resolution, const struct ContactImpulses *impulses) {
  const struct SwitchTable *switches = resolution->switches;
  size_t row = find_plane(resolution, impulses);
  size_t fixed = find_fixed(impulses);
  if (fixed < impulses->contact_count) contact_forces_report_fixed(resolution, impulses->member[fixed]);
  else if (row < impulses->count)
    log_message(
        resolution->instance, STATUS_DISCARD,
        "time %g: no impulses were found for an impact with the friction '%s', which acts in a plane; expected less "
        "friction, or another position",
        resolution->time, switches->frictions[impulses->member[row]].name);
  else
    log_message(resolution->instance, STATUS_DISCARD,
                "time %g: no impulses were found for an impact of the contact '%s'; expected less friction, or another "
                "position",
                resolution->time, switches->contacts[impulses->member[0]].name);
}

/* True if all rates are those of rest: the impact is a rounding error. */
static bool is_hit_at_rest(const struct Resolution *resolution, const struct ContactImpulses *impulses) {
  double fastest = 0.0;
  for (size_t i = 0; i < impulses->count; i++) fastest = fmax(fastest, fabs(impulses->rate[i]));
  return fastest <= tolerances_of(resolution).rest;
}

/* Warns at most once an instance that the impact has several outcomes. */
static void report_other_outcomes(const struct Resolution *resolution, struct ImpactProblem *problem) {
  const struct ContactImpulses *impulses = problem->impulses;
  const struct SwitchTable *switches = resolution->switches;
  if (impulses->friction_count == 0 || resolution->instance->reported_other_impulses) return;
  if (is_hit_at_rest(resolution, impulses)) return;
  fill_plain_rates(resolution, problem);
  if (!switches->friction_laws->has_other_impulses(resolution, impulses, problem->rate, problem->impulse)) return;
  resolution->instance->reported_other_impulses = true;
  log_message(resolution->instance, STATUS_WARNING,
              "time %g: an impact, such as of the contact '%s' with the friction '%s', has more than one solution; one "
              "of them is taken",
              resolution->time, switches->contacts[impulses->member[0]].name,
              switches->frictions[impulses->member[impulses->contact_count]].name);
}

static bool take_several(struct Resolution *resolution, const struct ContactImpulses *impulses, bool bounces) {
  struct ImpactProblem problem;
  bool is_done = create_problem(resolution, impulses, &problem) && find_fine_impulses(resolution, &problem, bounces);
  if (is_done) {
    report_other_outcomes(resolution, &problem);
    add_impulses(resolution, impulses, problem.impulse);
  } else report_impact(resolution, impulses);
  if (problem.block != NULL) scratch_return(resolution->instance, SCRATCH_IMPACT);
  return is_done;
}

bool impacts_take(struct Resolution *resolution, bool bounces) {
  struct ContactImpulses impulses;
  if (!contact_impulses_create(resolution, &impulses)) return false;
  bool is_done =
      impulses.count == 1 ? take_one(resolution, &impulses, bounces) : take_several(resolution, &impulses, bounces);
  contact_impulses_free(resolution, &impulses);
  resolution->changed = true;
  return is_done;
}
