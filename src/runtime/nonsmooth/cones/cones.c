#include "nonsmooth/cones/cones.h"

#include <float.h>
#include <math.h>

/*
 * Largest residual of a solution, relative to the largest rate. If there is no solution, the search only enlarges the
 * impulses. The residual then is small relative to the impulses, but remains of the size of the rates.
 */
static const double unsolved_share = 0.1;

double cones_rate_behind(const struct Cones *cones, size_t row) {
  const double *delassus = &cones->impulses->delassus[row * cones->impulses->count];
  double rate = cones->rate[row];
  for (size_t j = 0; j < cones->impulses->count; j++) rate += delassus[j] * cones->impulse[j];
  return rate;
}

double fill_rates_behind(const struct ContactImpulses *impulses, const double *rate, const double *impulse,
                         double *behind) {
  size_t n = impulses->count;
  double largest = 0.0;
  for (size_t i = 0; i < n; i++) {
    behind[i] = rate[i];
    largest = fmax(largest, fabs(rate[i]));
    for (size_t j = 0; j < n; j++) {
      double term = impulses->delassus[i * n + j] * impulse[j];
      behind[i] += term;
      largest = fmax(largest, fabs(term));
    }
  }
  return largest;
}

double cones_coefficient(const struct Cones *cones, size_t row, size_t deciding) {
  const struct ContactImpulses *impulses = cones->impulses;
  return impulses->coefficient[(row - impulses->contact_count) * impulses->deciding_count + deciding];
}

double cones_limit(const struct Cones *cones, size_t row) {
  return limit_with(cones->impulses, cones->impulse, row);
}

size_t cones_row_count(const struct Cones *cones, size_t row) {
  const struct ContactImpulses *impulses = cones->impulses;
  return row >= impulses->contact_count && is_in_plane(cones->resolution->switches, impulses->member[row]) ? 2 : 1;
}

double cones_largest(const struct Cones *cones) {
  double largest = 0.0;
  for (size_t i = 0; i < cones->impulses->count; i++)
    largest = fmax(largest, fabs(cones->scale[i] * cones->impulse[i]));
  return largest;
}

double cones_relative_miss(const struct Cones *cones, double miss) {
  double fastest = 0.0;
  for (size_t i = 0; i < cones->impulses->count; i++) fastest = fmax(fastest, fabs(cones->rate[i]));
  if (miss <= DBL_EPSILON * fastest) return 0.0;
  return miss < unsolved_share * fastest ? miss / cones_largest(cones) : INFINITY;
}
