/*
 * Enumerates the outcomes of an impact with frictions along lines, as active sets of its complementarity
 * conditions. Each contact opens or presses, each friction sticks or slides either way. In each of the 2^contacts
 * 3^frictions combinations, the impulses of pressing contacts and of sticking frictions follow from rates of 0, by
 * elimination. The other impulses follow from Coulomb's law. The combination is an outcome if impulses and rates
 * have the signs that it assumes; a singular one is skipped. If impulses are not unique, one of the solutions has a
 * friction at its limit. The combination in which this friction slides at a rate of 0 finds it.
 */
#include "nonsmooth/contacts/impact_outcomes.h"

#include <float.h>
#include <math.h>

#include "nonsmooth/contacts/elimination.h"
#include "nonsmooth/contacts/impacts.h"

/* Impulses up to which all combinations are tried: at most 3^8 = 6561. */
enum { MOST_IMPULSES = 8 };

/* Violations below this share of the largest impulse (or of 1, if that is larger) are rounding errors. */
static const double rounded_impulse = 1e-9;

/* Scaled such that W_ii = 1 for each impulse, and to a largest rate of 1. */
struct Combination {
  const struct ContactImpulses *impulses;
  double unit[MOST_IMPULSES], rate[MOST_IMPULSES], impulse[MOST_IMPULSES];
  double scale[MOST_IMPULSES]; /* factor from scaled to physical impulses */
  int way[MOST_IMPULSES];      /* contact: 1 if it presses, else 0; friction: sign of its sliding, 0 if it sticks */
  size_t sought[MOST_IMPULSES], sought_count; /* rows with a rate of 0, whose impulses are unknown */
  double equations[MOST_IMPULSES * (MOST_IMPULSES + 1)];
};

static bool is_contact_in(const struct Combination *combination, size_t row) {
  return row < combination->impulses->contact_count;
}

static double delassus_between(const struct Combination *combination, size_t i, size_t j) {
  const struct ContactImpulses *impulses = combination->impulses;
  return impulses->delassus[i * impulses->count + j] * combination->unit[i] * combination->unit[j];
}

/* Returns the friction limit by a unit impulse of a contact. */
static double coefficient_of(const struct Combination *combination, size_t friction, size_t contact) {
  size_t contacts = combination->impulses->contact_count;
  double unit = combination->unit[friction];
  if (!(unit > 0.0)) return 0.0;
  return combination->impulses->coefficient[(friction - contacts) * contacts + contact] * combination->unit[contact] /
         unit;
}

static double limit_in(const struct Combination *combination, size_t friction) {
  double limit = 0.0;
  for (size_t i = 0; i < combination->impulses->contact_count; i++)
    limit += coefficient_of(combination, friction, i) * combination->impulse[i];
  return limit;
}

static double rate_behind_in(const struct Combination *combination, size_t row) {
  double rate = combination->rate[row];
  for (size_t j = 0; j < combination->impulses->count; j++)
    rate += delassus_between(combination, row, j) * combination->impulse[j];
  return rate;
}

/* Returns the change of a rate by a unit of an unknown impulse, including that of the frictions that slide on it. */
static double effect_in(const struct Combination *combination, size_t row, size_t push) {
  double sum = delassus_between(combination, row, push);
  for (size_t f = combination->impulses->contact_count;
       f < combination->impulses->count && is_contact_in(combination, push); f++)
    sum -= combination->way[f] * coefficient_of(combination, f, push) * delassus_between(combination, row, f);
  return sum;
}

static bool find_combined_impulses(struct Combination *combination) {
  size_t n = 0, count = combination->impulses->count;
  for (size_t i = 0; i < count; i++)
    if (is_contact_in(combination, i) == (combination->way[i] != 0)) combination->sought[n++] = i;
  for (size_t i = 0; i < n; i++) {
    double *row = combination->equations + i * (n + 1);
    for (size_t j = 0; j < n; j++) row[j] = effect_in(combination, combination->sought[i], combination->sought[j]);
    row[n] = -combination->rate[combination->sought[i]];
  }
  if (!solve_by_elimination(n, combination->equations, usual_least_pivot)) return false;
  for (size_t i = 0; i < count; i++) combination->impulse[i] = 0.0;
  for (size_t i = 0; i < n; i++) combination->impulse[combination->sought[i]] = combination->equations[i * (n + 1) + n];
  for (size_t f = combination->impulses->contact_count; f < count; f++)
    if (combination->way[f] != 0) combination->impulse[f] = -combination->way[f] * limit_in(combination, f);
  return true;
}

static bool fulfils_law(const struct Combination *combination) {
  double size = 1.0;
  bool is_fine = true;
  for (size_t i = 0; i < combination->impulses->count; i++) size = fmax(size, fabs(combination->impulse[i]));
  for (size_t i = 0; i < combination->impulses->count; i++) {
    double impulse = combination->impulse[i], spare;
    if (is_contact_in(combination, i)) spare = combination->way[i] != 0 ? impulse : rate_behind_in(combination, i);
    else if (combination->way[i] == 0) spare = limit_in(combination, i) - fabs(impulse);
    else spare = combination->way[i] * rate_behind_in(combination, i);
    is_fine &= spare >= -rounded_impulse * size;
  }
  return is_fine;
}

/* Advances to the next combination, as digits of a number; false after the last. */
static bool next_ways(struct Combination *combination) {
  for (size_t i = 0; i < combination->impulses->count; i++) {
    if (combination->way[i]++ < 1) return true;
    combination->way[i] = is_contact_in(combination, i) ? 0 : -1;
  }
  return false;
}

static void fill_units(struct Combination *combination, const double *rate) {
  const struct ContactImpulses *impulses = combination->impulses;
  double largest = 0.0;
  for (size_t i = 0; i < impulses->count; i++) {
    double own = impulses->delassus[i * impulses->count + i];
    combination->unit[i] = own > DBL_MIN ? 1.0 / sqrt(own) : 0.0;
    combination->rate[i] = rate[i] * combination->unit[i];
    combination->way[i] = is_contact_in(combination, i) ? 0 : -1;
    largest = fmax(largest, fabs(combination->rate[i]));
  }
  for (size_t i = 0; i < impulses->count && largest > 0.0; i++) {
    combination->rate[i] /= largest;
    combination->scale[i] = combination->unit[i] * largest;
  }
}

bool impact_has_others(const struct Resolution *resolution, const struct ContactImpulses *impulses, const double *rate,
                       const double *impulse) {
  (void)resolution;
  if (impulses->count > MOST_IMPULSES) return false;
  struct Combination combination = {.impulses = impulses};
  bool is_other = false;
  fill_units(&combination, rate);
  do {
    double candidate[MOST_IMPULSES];
    if (!find_combined_impulses(&combination) || !fulfils_law(&combination)) continue;
    for (size_t i = 0; i < impulses->count; i++) candidate[i] = combination.impulse[i] * combination.scale[i];
    is_other = is_other_outcome(impulses, candidate, impulse);
  } while (!is_other && next_ways(&combination));
  return is_other;
}
