/*
 * Detects stiffness from a Taylor step, and predicts the step of an implicit method.
 *
 * A system is stiff if the stability of fast modes, which have decayed, limits the step, and not the accuracy of the
 * slow motion. The last terms at the end of such a step are those of the fast modes, a z^k / k! with z = rate * step.
 * The terms of orders p and p - 2 give a and z. The first terms are those of the slow motion, which fall geometrically.
 * An implicit method of order o may take a step longer by the factor r, with errors a (r z)^o / o! in the fast modes
 * and of the same order in the slow motion.
 */
#include "methods/stiffness.h"

#include <float.h>
#include <math.h>

/* Returns the largest term of an order at the end of the step, in units of the scales. */
static double size_of_term(const struct Taylor *taylor, int64_t order) {
  double largest = 0.0;
  for (size_t i = 0; i < lagrangian.state_count; i++)
    largest = fmax(largest, fabs(taylor->step.x[i][order]) / taylor_scale(&taylor->step, i));
  return largest * pow(taylor->saved->interval, (double)order);
}

/* The parameters a and z of the fast modes. */
struct FastModes {
  double amplitude, angle;
};

static struct FastModes fast_modes(const struct Taylor *taylor) {
  int64_t order = taylor->saved->order;
  double p = (double)order, last = size_of_term(taylor, order), before = size_of_term(taylor, order - 2);
  if (!(last > 0.0) || !(before > 0.0)) return (struct FastModes){.amplitude = INFINITY, .angle = INFINITY};
  double angle = sqrt(p * (p - 1.0) * last / before);
  return (struct FastModes){.amplitude = last * exp(lgamma(p + 1.0) - p * log(angle)), .angle = angle};
}

/* Returns the multiple r of the last step at which the fast modes' error a (r z)^order / order! is the tolerance. */
static double multiple_for_fast(struct FastModes fast, int order, double tolerance) {
  if (fast.amplitude < tolerance) return INFINITY; /* modes that the implicit method may damp */
  return pow(tolerance * tgamma(order + 1.0) / fast.amplitude, 1.0 / order) / fast.angle;
}

/*
 * Returns this multiple for the slow motion. The ratio by which its terms fall follows from the terms that exceed
 * those of the fast modes. If the second term does not, the ratio lies between the first term and the bound that
 * the fast modes set. Their geometric mean is taken.
 */
static double multiple_for_slow(const struct Taylor *taylor, struct FastModes fast, int order, double tolerance) {
  enum { OUTSTANDING = 4 };
  double first = size_of_term(taylor, 1), last = first, hidden = OUTSTANDING * fast.amplitude * fast.angle;
  if (first <= hidden || first <= tolerance) return INFINITY;
  int64_t k = 1;
  for (; k < taylor->saved->order / 2; k++) {
    double next = size_of_term(taylor, k + 1);
    hidden *= fast.angle / (double)(k + 1);
    if (next <= hidden) break;
    last = next;
  }
  double share = k > 1 ? pow(last / first, 1.0 / (double)(k - 1)) : sqrt(fmin(hidden / first, 1.0) * first);
  return pow(tolerance / first, 1.0 / order) / fmax(share, DBL_EPSILON);
}

/*
 * True if the last terms may be those of fast modes, z^k / k! with z of about order / e, which fall by the factor e. If
 * the motion itself limits the step, they fall by exp(1.5) to exp(2), the choice of taylor_rule.h.
 */
static bool may_be_fast(const struct Taylor *taylor) {
  int64_t order = taylor->saved->order;
  double last = 0.0, before = 0.0;
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    double scale = taylor_scale(&taylor->step, i);
    last = fmax(last, fabs(taylor->step.x[i][order]) / scale);
    before = fmax(before, fabs(taylor->step.x[i][order - 2]) / scale);
  }
  double share = 1.0 / FALL_OF_FAST / taylor->saved->interval;
  return last > share * share * before;
}

double predicted_stiffness(const struct Taylor *taylor, int order, double tolerance) {
  if (!may_be_fast(taylor)) return 0.0;
  struct FastModes fast = fast_modes(taylor);
  return fmin(multiple_for_fast(fast, order, tolerance), multiple_for_slow(taylor, fast, order, tolerance));
}

/* Columns or rows of the Jacobian, from first to end - 1. */
struct IndexRange {
  size_t first, end;
};

/* Velocities, and so accelerations, are measured in units of their coordinates' scales. */
static double scale_of_state(size_t state) {
  size_t n = lagrangian.coordinate_count;
  return lagrangian.steps.nominal[state >= n && state < 2 * n ? state - n : state];
}

/* Returns the norm of a block: the largest row sum of its elements in these units. sum: workspace. */
static double norm_of_block(const double *jacobian, struct IndexRange rows, struct IndexRange columns, double *sum) {
  const struct Sparsity *pattern = &lagrangian.implicit.pattern;
  for (size_t i = rows.first; i < rows.end; i++) sum[i - rows.first] = 0.0;
  for (size_t j = columns.first; j < columns.end; j++) {
    for (int e = pattern->start[j]; e < pattern->start[j + 1]; e++) {
      size_t row = (size_t)pattern->row[e];
      if (row >= rows.first && row < rows.end)
        sum[row - rows.first] += fabs(jacobian[e]) * scale_of_state(j) / scale_of_state(row);
    }
  }
  double largest = 0.0;
  for (size_t i = rows.first; i < rows.end; i++) largest = fmax(largest, sum[i - rows.first]);
  return largest;
}

/*
 * Modes of the coordinates obey rate^2 = damping * rate + stiffness. The other states z add their own rates, and those
 * of the loops v -> z -> v and v -> q -> z -> v, whose rates are roots of order 2 and 3 of the products of norms.
 */
double stiffness_rate(const double *jacobian, double *work) {
  size_t n = lagrangian.coordinate_count;
  const struct IndexRange q = {0, n}, v = {n, 2 * n}, z = {2 * n, lagrangian.state_count};
  double stiffness = norm_of_block(jacobian, v, q, work), damping = norm_of_block(jacobian, v, v, work);
  double rate = 0.5 * (damping + sqrt(damping * damping + 4.0 * stiffness));
  if (z.first == z.end) return rate;
  double coupling = norm_of_block(jacobian, v, z, work);
  return rate + norm_of_block(jacobian, z, z, work) + sqrt(coupling * norm_of_block(jacobian, z, v, work)) +
         cbrt(coupling * norm_of_block(jacobian, z, q, work));
}
