#include "nonsmooth/cones/impulses.h"

#include <math.h>

#include "arithmetic.h"

/* Energy gains below this fraction of the terms of the work are rounding errors. */
static const double least_gain = 1e-13;

/*
 * Two outcomes differ if the difference of their impulses, applied at rest, makes more than this fraction of their
 * energies.
 */
static const double differing_share = 1e-8;

double limit_with(const struct ContactImpulses *impulses, const double *impulse, size_t row) {
  size_t friction = row - impulses->contact_count, count = impulses->deciding_count;
  double limit = impulses->given != NULL ? impulses->given[friction] : 0.0;
  for (size_t i = 0; i < count; i++) limit += impulses->coefficient[friction * count + i] * impulse[i];
  return limit;
}

double change_of_rate(const struct ContactImpulses *impulses, const double *impulse, size_t row) {
  double change = 0.0;
  for (size_t j = 0; j < impulses->count; j++) change += impulses->delassus[row * impulses->count + j] * impulse[j];
  return change;
}

bool gains_energy(const struct ContactImpulses *impulses, const double *impulse) {
  double work = 0.0, size = 0.0;
  for (size_t i = 0; i < impulses->count; i++) {
    double change = change_of_rate(impulses, impulse, i);
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
