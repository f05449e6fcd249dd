/*
 * A system is stiff where a step is short only so that fast modes which died away do not grow again. The last
 * coefficients of the Taylor series then are those of the fast modes, which go like a z^k / k!, z = rate x step, and the
 * first ones those of the slow motion, which fall off at once.
 */
#include "methods/stiffness.h"

#include <float.h>
#include <math.h>

/* The largest term of an order at the end of the step, in units of the variables' scales. */
static double size_of_term(const struct Taylor *taylor, int64_t order) {
  double largest = 0.0;
  for (size_t i = 0; i < lagrangian.state_count; i++)
    largest = fmax(largest, fabs(taylor->x[i][order]) / taylor_scale(taylor, i));
  return largest * pow(taylor->saved->reach, (double)order);
}

/* a and z of the fast modes, from the last terms. */
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

/* The step that an error a (r z)^order / order! allows, as a multiple r of the last one. */
static double multiple_for_fast(struct FastModes fast, int order, double tolerance) {
  if (fast.amplitude < tolerance) return INFINITY; /* what an implicit method need not follow */
  return pow(tolerance * tgamma(order + 1.0) / fast.amplitude, 1.0 / order) / fast.angle;
}

/*
 * The same for the slow motion, whose terms fall off by a share that those show which stand out of the fast modes'. Where
 * the second one does not, the share lies between the first term, the part of its scale by which the state changes, and
 * what would show.
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
 * Whether the last terms can be those of fast modes, a z^k / k! with a z of about order / e. Where the motion itself
 * bounds the step they fall off by exp(-2) from one to the next, as the step was chosen so.
 */
static bool may_be_fast(const struct Taylor *taylor) {
  int64_t order = taylor->saved->order;
  double last = 0.0, before = 0.0;
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    double scale = taylor_scale(taylor, i);
    last = fmax(last, fabs(taylor->x[i][order]) / scale);
    before = fmax(before, fabs(taylor->x[i][order - 2]) / scale);
  }
  double share = 1.0 / FALL_OF_FAST / taylor->saved->reach;
  return last > share * share * before;
}

double stiffness_promise(const struct Taylor *taylor, int order, double tolerance) {
  if (!may_be_fast(taylor)) return 0.0;
  struct FastModes fast = fast_modes(taylor);
  return fmin(multiple_for_fast(fast, order, tolerance), multiple_for_slow(taylor, fast, order, tolerance));
}

/*
 * The largest sum over a row of the elements in columns from .. from + n - 1, of the accelerations in units of the
 * coordinates' scales.
 */
static double norm_of_block(const double *jacobian, size_t from, double *sum) {
  const struct Sparsity *pattern = &lagrangian.implicit.pattern;
  size_t n = lagrangian.coordinate_count;
  const double *scale = lagrangian.steps.nominal;
  for (size_t i = 0; i < n; i++) sum[i] = 0.0;
  for (size_t j = 0; j < n; j++) {
    for (int e = pattern->start[from + j]; e < pattern->start[from + j + 1]; e++) {
      size_t row = (size_t)pattern->row[e];
      if (row >= n && row < 2 * n) sum[row - n] += fabs(jacobian[e]) * scale[j] / scale[row - n];
    }
  }
  double largest = 0.0;
  for (size_t i = 0; i < n; i++) largest = fmax(largest, sum[i]);
  return largest;
}

/* The modes are roots of rate^2 = damping rate + stiffness. */
double stiffness_rate(const double *jacobian, double *work) {
  size_t n = lagrangian.coordinate_count;
  double stiffness = norm_of_block(jacobian, 0, work), damping = norm_of_block(jacobian, n, work);
  return 0.5 * (damping + sqrt(damping * damping + 4.0 * stiffness));
}
