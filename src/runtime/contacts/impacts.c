/*
 * The law of impacts. Of each contact that is hit, the impulse p and the rate of the gap behind it, u, fulfil
 *
 *   p >= 0,   u + e (rate before) >= 0,   p (u + e (rate before)) = 0,
 *
 * and of each friction that rests on such contacts the impulse is at most mu p, is that where it slides behind the impact,
 * against the velocity, and what it takes to stick where it does not: one linear complementarity problem for all. Without
 * restitution it has a solution, which never gains energy; with e it may gain some (Kane's paradox). Then all
 * restitutions are lessened by one factor, as little as keeps the energy from growing.
 */
#include "contacts/impacts.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "contacts/complementarity.h"
#include "contacts/contact_forces.h"
#include "contacts/planes.h"
#include "contacts/pushes.h"
#include "evaluation/evaluate.h"
#include "evaluation/services.h"

enum { HALVINGS = 52, SOLUTIONS = 50 };

/* Less energy than this share may be gained by rounding. */
static const double least_gain = 1e-13;

/* Outcomes differ where what their impulses differ by makes more than this share of the energy that they make. */
static const double differing_share = 1e-8;

/* In units of the largest velocity: what moves less rests, but for rounding. */
static const double resting_share = 1e-9;

/*
 * What is added to the mobilities keeps impulses small where they are not determined; further solutions remove what it does
 * to them. Where rounding leads the way of the first astray, the next is tried.
 */
static const double regularizations[] = {1e-8, 1e-6, 1e-10, 1e-7};

/*
 * In units in which the mobility of each push by itself is 1. Rows of the problem: the impulses of contacts, those of
 * frictions along their velocities, those against them, and how fast these slide.
 */
struct ImpactProblem {
  const struct Pushes *pushes;
  size_t count;
  double *unit; /* of the impulse of each push */
  double *matrix, *rate, *q, *z, *next, *work;
  double *impulse; /* of each push */
  double share;    /* of the restitutions, with which the impulses were sought last */
  void *block;
};

static size_t first_row(const struct ImpactProblem *problem, size_t part) {
  const struct Pushes *pushes = problem->pushes;
  return part == 0 ? 0 : pushes->contact_count + (part - 1) * pushes->friction_count;
}

/* The rows of a push, of which frictions have two. */
static void fill_mobility(struct ImpactProblem *problem, size_t i, size_t j) {
  const struct Pushes *pushes = problem->pushes;
  size_t contacts = pushes->contact_count, frictions = pushes->friction_count, n = problem->count;
  double value = pushes->mobility[i * pushes->count + j] * problem->unit[i] * problem->unit[j];
  for (size_t side = 0; side < (i < contacts ? 1u : 2u); side++)
    for (size_t other = 0; other < (j < contacts ? 1u : 2u); other++)
      problem->matrix[(i + side * frictions) * n + j + other * frictions] = side == other ? value : -value;
}

static void fill_friction(struct ImpactProblem *problem, size_t friction) {
  const struct Pushes *pushes = problem->pushes;
  size_t n = problem->count, contacts = pushes->contact_count;
  size_t along = first_row(problem, 1) + friction, against = first_row(problem, 2) + friction,
         slides = first_row(problem, 3) + friction;
  double unit = problem->unit[contacts + friction];
  problem->matrix[along * n + slides] = problem->matrix[against * n + slides] = 1.0;
  problem->matrix[slides * n + along] = problem->matrix[slides * n + against] = -1.0;
  for (size_t i = 0; i < contacts && unit > 0.0; i++)
    problem->matrix[slides * n + i] = pushes->coefficient[friction * contacts + i] * problem->unit[i] / unit;
}

/* False where a contact cannot be moved, or there is no memory. */
static bool create_problem(struct Settlement *settlement, const struct Pushes *pushes, struct ImpactProblem *problem) {
  size_t n = pushes->contact_count + 3 * pushes->friction_count, count = pushes->count;
  size_t numbers = 2 * count + n * n + 4 * n + complementarity_work_count(n);
  *problem = (struct ImpactProblem){.pushes = pushes, .count = n};
  problem->block = scratch_take(settlement->instance, SCRATCH_IMPACT, numbers * sizeof(double));
  if (problem->block == NULL) {
    solver_lacks_memory(settlement->instance);
    return false;
  }
  problem->unit = problem->block;
  problem->impulse = problem->unit + count;
  problem->matrix = problem->impulse + count;
  problem->rate = problem->matrix + n * n;
  problem->q = problem->rate + n;
  problem->z = problem->q + n;
  problem->next = problem->z + n;
  problem->work = problem->next + n;
  bool moves = true;
  for (size_t i = 0; i < count; i++) {
    double mobility = pushes->mobility[i * count + i];
    problem->unit[i] = mobility > DBL_MIN ? 1.0 / sqrt(mobility) : 0.0;
    moves &= i >= pushes->contact_count || problem->unit[i] > 0.0;
  }
  for (size_t i = 0; i < count; i++)
    for (size_t j = 0; j < count; j++) fill_mobility(problem, i, j);
  for (size_t f = 0; f < pushes->friction_count; f++) fill_friction(problem, f);
  return moves;
}

/*
 * The restitution of a contact; 0 where what bounces would be lost. The friction of a bounce that is cut short is then that
 * of the rest: together they push as much as all bounces to come.
 */
static double restitution_of(const struct Settlement *settlement, size_t contact) {
  double restitution = contact_value(settlement, contact, CONTACT_RESTITUTION);
  double rate = -restitution * contact_value(settlement, contact, CONTACT_RATE);
  return bounce_is_lost(settlement, contact, rate) ? 0.0 : restitution;
}

/* What a share of the restitution makes of the rate of a push that is to be kept from falling below 0. */
static double rise_by_restitution(const struct Settlement *settlement, const struct Pushes *pushes, size_t push,
                                  double share) {
  double bounce = push < pushes->contact_count ? restitution_of(settlement, pushes->member[push]) : 0.0;
  return 1.0 + (pushes->rate[push] < 0.0 ? share * bounce : 0.0);
}

/* Rates that are to be kept from falling below 0, as shares of the largest. Returns this. */
static double fill_rates(const struct Settlement *settlement, struct ImpactProblem *problem, double share) {
  const struct Pushes *pushes = problem->pushes;
  double largest = 0.0;
  memset(problem->rate, 0, problem->count * sizeof *problem->rate);
  for (size_t i = 0; i < pushes->count; i++) {
    bool is_contact = i < pushes->contact_count;
    double rate = pushes->rate[i] * problem->unit[i] * rise_by_restitution(settlement, pushes, i, share);
    problem->rate[i] = rate;
    if (!is_contact) problem->rate[i + pushes->friction_count] = -rate;
    largest = fmax(largest, fabs(rate));
  }
  for (size_t i = 0; i < problem->count && largest > 0.0; i++) problem->rate[i] /= largest;
  return largest;
}

/* Whether the next solution differs from the one before by more than rounding. */
static bool take_next(struct ImpactProblem *problem, double regularization) {
  double change = 0.0, size = 0.0;
  for (size_t i = 0; i < problem->count; i++) {
    change = fmax(change, fabs(problem->next[i] - problem->z[i]));
    size = fmax(size, fabs(problem->next[i]));
  }
  memcpy(problem->z, problem->next, problem->count * sizeof *problem->z);
  return regularization * change > 0.1 * DBL_EPSILON * size;
}

/* Solves the problem until the regularization has no part in it any more. False where that cannot be. */
static bool solve_regularized(struct ImpactProblem *problem, double regularization) {
  size_t n = problem->count, regular = first_row(problem, 3);
  bool is_solved = true, changes = true;
  memset(problem->z, 0, n * sizeof *problem->z);
  for (size_t i = 0; i < regular; i++) problem->matrix[i * n + i] += regularization;
  for (int count = 0; count < SOLUTIONS && is_solved && changes; count++) {
    for (size_t i = 0; i < n; i++)
      problem->q[i] = problem->rate[i] - (i < regular ? regularization * problem->z[i] : 0.0);
    is_solved = complementarity_solve(n, problem->matrix, problem->q, problem->next, problem->work);
    if (is_solved) changes = take_next(problem, regularization);
  }
  for (size_t i = 0; i < regular; i++) problem->matrix[i * n + i] -= regularization;
  return is_solved;
}

/* The first friction among them that acts in a plane, as a row of the pushes; their number for none. */
static size_t find_plane(const struct Settlement *settlement, const struct Pushes *pushes) {
  size_t row = pushes->contact_count;
  while (row < pushes->count && !is_in_plane(settlement->switches, pushes->member[row])) row++;
  return row;
}

/* The rates that are to be kept from falling below 0. */
static void fill_plain_rates(const struct Settlement *settlement, struct ImpactProblem *problem) {
  const struct Pushes *pushes = problem->pushes;
  for (size_t i = 0; i < pushes->count; i++)
    problem->rate[i] = pushes->rate[i] * rise_by_restitution(settlement, pushes, i, problem->share);
}

/* The impulses where frictions act in planes, whose cones are no linear problem. */
static bool find_impulses_in_planes(const struct Settlement *settlement, struct ImpactProblem *problem) {
  const struct Pushes *pushes = problem->pushes;
  fill_plain_rates(settlement, problem);
  return settlement->switches->friction_laws->find_impulses(settlement, pushes, problem->rate, problem->impulse);
}

/* The impulses with a share of the restitutions. False where there are none. */
static bool find_impulses(const struct Settlement *settlement, struct ImpactProblem *problem, double share) {
  const struct Pushes *pushes = problem->pushes;
  problem->share = share;
  if (find_plane(settlement, pushes) < pushes->count) return find_impulses_in_planes(settlement, problem);
  double scale = fill_rates(settlement, problem, share);
  bool is_solved = false;
  for (size_t i = 0; i < sizeof regularizations / sizeof *regularizations && !is_solved; i++)
    is_solved = solve_regularized(problem, regularizations[i]);
  for (size_t i = 0; i < pushes->count; i++) {
    double against = i < pushes->contact_count ? 0.0 : problem->z[i + pushes->friction_count];
    problem->impulse[i] = (problem->z[i] - against) * problem->unit[i] * scale;
  }
  return is_solved;
}

/* Whether impulses do more work than rounding. */
static bool gains_energy(const struct Pushes *pushes, const double *impulse) {
  double work = 0.0, size = 0.0;
  for (size_t i = 0; i < pushes->count; i++) {
    double change = 0.0;
    for (size_t j = 0; j < pushes->count; j++) change += pushes->mobility[i * pushes->count + j] * impulse[j];
    work += impulse[i] * (pushes->rate[i] + 0.5 * change);
    size += fabs(impulse[i]) * (fabs(pushes->rate[i]) + 0.5 * fabs(change));
  }
  return work > least_gain * size;
}

/* Twice the energy of the motion that impulses, less a share of others, make of rest. */
static double energy_made(const struct Pushes *pushes, const double *impulse, const double *other, double share) {
  double sum = 0.0;
  for (size_t i = 0; i < pushes->count; i++)
    for (size_t j = 0; j < pushes->count; j++)
      sum +=
          (impulse[i] - share * other[i]) * pushes->mobility[i * pushes->count + j] * (impulse[j] - share * other[j]);
  return sum;
}

bool is_other_outcome(const struct Pushes *pushes, const double *impulse, const double *found) {
  double size = energy_made(pushes, impulse, found, 0.0) + energy_made(pushes, found, impulse, 0.0);
  return energy_made(pushes, impulse, found, 1.0) > differing_share * size && !gains_energy(pushes, impulse);
}

static bool is_fine(const struct Settlement *settlement, struct ImpactProblem *problem, double share) {
  return find_impulses(settlement, problem, share) && !gains_energy(problem->pushes, problem->impulse);
}

/* With the largest share of the restitutions that does not gain energy. */
static bool find_fine_impulses(const struct Settlement *settlement, struct ImpactProblem *problem, bool bounces) {
  if (!bounces) return find_impulses(settlement, problem, 0.0);
  if (is_fine(settlement, problem, 1.0)) return true;
  double fine = 0.0, too_much = 1.0;
  for (int i = 0; i < HALVINGS; i++) {
    double middle = 0.5 * (fine + too_much);
    if (is_fine(settlement, problem, middle)) fine = middle;
    else too_much = middle;
  }
  return find_impulses(settlement, problem, fine);
}

static void add_impulses(struct Settlement *settlement, const struct Pushes *pushes, const double *impulse) {
  double *velocity = settlement->state + lagrangian.coordinate_count;
  for (size_t i = 0; i < pushes->count; i++)
    for (size_t k = 0; k < lagrangian.coordinate_count; k++)
      velocity[k] += impulse[i] * pushes->velocities[i * lagrangian.coordinate_count + k];
}

/* A contact that is hit alone, without friction. */
static bool take_one(struct Settlement *settlement, const struct Pushes *pushes, bool bounces) {
  double bounce = bounces ? restitution_of(settlement, pushes->member[0]) : 0.0;
  double impulse = fmax(-(1.0 + bounce) * pushes->rate[0] / pushes->mobility[0], 0.0);
  if (!(pushes->mobility[0] > DBL_MIN)) {
    contact_forces_refuse_fixed(settlement, pushes->member[0]);
    return false;
  }
  add_impulses(settlement, pushes, &impulse);
  return true;
}

/* The first contact whose gap no impulse changes; their number for none. */
static size_t find_fixed(const struct Pushes *pushes) {
  size_t row = 0;
  while (row < pushes->contact_count && pushes->mobility[row * pushes->count + row] > DBL_MIN) row++;
  return row;
}

static void refuse_impact(const struct Settlement *settlement, const struct Pushes *pushes) {
  const struct SwitchTable *switches = settlement->switches;
  size_t row = find_plane(settlement, pushes);
  size_t fixed = find_fixed(pushes);
  if (fixed < pushes->contact_count) contact_forces_refuse_fixed(settlement, pushes->member[fixed]);
  else if (row < pushes->count)
    log_message(
        settlement->instance, STATUS_DISCARD,
        "time %g: no impulses were found for an impact with the friction '%s', which acts in a plane; expected less "
        "friction, or another position",
        settlement->time, switches->frictions[pushes->member[row]].name);
  else
    log_message(settlement->instance, STATUS_DISCARD,
                "time %g: no impulses were found for an impact of the contact '%s'; expected less friction, or another "
                "position",
                settlement->time, switches->contacts[pushes->member[0]].name);
}

/* Whether all that is hit closes and slides as slowly as what rests: an impact by rounding alone. */
static bool is_hit_at_rest(const struct Settlement *settlement, const struct Pushes *pushes) {
  double fastest = 0.0;
  for (size_t i = 0; i < pushes->count; i++) fastest = fmax(fastest, fabs(pushes->rate[i]));
  return fastest <= resting_share * largest_scale(settlement->state, lagrangian.coordinate_count);
}

/* Once, so that what bounces for long does not fill the log. */
static void tell_of_other_outcomes(const struct Settlement *settlement, struct ImpactProblem *problem) {
  const struct Pushes *pushes = problem->pushes;
  const struct SwitchTable *switches = settlement->switches;
  if (pushes->friction_count == 0 || settlement->instance->told_other_impulses) return;
  if (is_hit_at_rest(settlement, pushes)) return;
  fill_plain_rates(settlement, problem);
  if (!switches->friction_laws->has_other_impulses(settlement, pushes, problem->rate, problem->impulse)) return;
  settlement->instance->told_other_impulses = true;
  log_message(settlement->instance, STATUS_WARNING,
              "time %g: an impact, such as of the contact '%s' with the friction '%s', has more than one solution; one "
              "of them is taken",
              settlement->time, switches->contacts[pushes->member[0]].name,
              switches->frictions[pushes->member[pushes->contact_count]].name);
}

static bool take_several(struct Settlement *settlement, const struct Pushes *pushes, bool bounces) {
  struct ImpactProblem problem;
  bool is_done = create_problem(settlement, pushes, &problem) && find_fine_impulses(settlement, &problem, bounces);
  if (is_done) {
    tell_of_other_outcomes(settlement, &problem);
    add_impulses(settlement, pushes, problem.impulse);
  } else refuse_impact(settlement, pushes);
  if (problem.block != NULL) scratch_return(settlement->instance, SCRATCH_IMPACT);
  return is_done;
}

bool impacts_take(struct Settlement *settlement, bool bounces) {
  struct Pushes pushes;
  if (!pushes_create(settlement, &pushes)) return false;
  bool is_done =
      pushes.count == 1 ? take_one(settlement, &pushes, bounces) : take_several(settlement, &pushes, bounces);
  pushes_free(settlement, &pushes);
  settlement->changed = true;
  return is_done;
}
