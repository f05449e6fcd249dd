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

/* Columns or rows of the Jacobian: from first to end - 1. */
struct Range {
  size_t first, end;
};

/* Accelerations count in units of their coordinates' scales, and so do velocities. */
static double scale_of_state(size_t state) {
  size_t n = lagrangian.coordinate_count;
  return lagrangian.steps.nominal[state >= n && state < 2 * n ? state - n : state];
}

/* The largest sum over one of the rows of the elements in the columns. */
static double norm_of_block(const double *jacobian, struct Range rows, struct Range columns, double *sum) {
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
 * The modes of the coordinates are roots of rate^2 = damping rate + stiffness. States behind the velocities add their own rates, and those
 * of the circles from the accelerations by them and back by velocities or coordinates.
 */
double stiffness_rate(const double *jacobian, double *work) {
  size_t n = lagrangian.coordinate_count;
  const struct Range q = {0, n}, v = {n, 2 * n}, z = {2 * n, lagrangian.state_count};
  double stiffness = norm_of_block(jacobian, v, q, work), damping = norm_of_block(jacobian, v, v, work);
  double rate = 0.5 * (damping + sqrt(damping * damping + 4.0 * stiffness));
  if (z.first == z.end) return rate;
  double drive = norm_of_block(jacobian, v, z, work);
  return rate + norm_of_block(jacobian, z, z, work) + sqrt(drive * norm_of_block(jacobian, z, v, work)) +
         cbrt(drive * norm_of_block(jacobian, z, q, work));
}
