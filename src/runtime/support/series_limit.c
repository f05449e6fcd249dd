#include "series_limit.h"

#include <math.h>

/* Change of the argument of exp over which Taylor polynomials of the usual orders follow it. */
static const double exponent_range = 5.0;
/* exp is negligible below the first, and tanh rounds to 1 above the second. */
static const double exponential_end = -700.0, tanh_end = 20.0;
/* Fraction of the distance to a singularity that one step may go. */
static const double approach = 0.99;
/* Below this base, powers above HIGHEST_WIDE_POWER are negligible, and its turning points are rounding errors. */
static const double negligible_base = 1e-50;
static const double pi = 3.14159265358979323846;

/* Divisions of the step by 8, enough to pass through all doubles; then bisections of the last factor, to 14 %. */
enum { TRIALS = 400, REFINEMENTS = 4 };

/* Returns sum over k >= 1 of |u_k| step^k, by four independent chains of Horner's rule. */
static double excursion(const double *u, int order, double step) {
  double square = step * step, fourth = square * square;
  int k = (order - 1) / 4 * 4 + 1;
  double first = fabs(u[k]), second = k + 1 <= order ? fabs(u[k + 1]) : 0.0;
  double third = k + 2 <= order ? fabs(u[k + 2]) : 0.0, last = k + 3 <= order ? fabs(u[k + 3]) : 0.0;
  for (k -= 4; k > 0; k -= 4) {
    first = first * fourth + fabs(u[k]);
    second = second * fourth + fabs(u[k + 1]);
    third = third * fourth + fabs(u[k + 2]);
    last = last * fourth + fabs(u[k + 3]);
  }
  return step * ((first + step * second) + square * (third + step * last));
}

typedef bool Fits(const double *u, int order, double step, double bound);

static bool excursion_fits(const double *u, int order, double step, double bound) {
  return excursion(u, order, step) <= bound;
}

/* True if u has no turning point in the step: its first nonzero derivative outweighs the sum of all further terms. */
static bool is_monotone(const double *u, int order, double step) {
  int first = 1;
  while (first <= order && u[first] == 0.0) first++;
  double others = 0.0, power = step;
  for (int k = first + 1; k <= order; k++, power *= step) others += k * fabs(u[k]) * power;
  return first > order || others <= first * fabs(u[first]);
}

/*
 * True if a power of u cannot hide a change in the step. A power of a base without turning points is largest at an end
 * of the step, where the defect is measured.
 */
static bool power_fits(const double *u, int order, double step, double bound) {
  return excursion(u, order, step) <= bound || is_monotone(u, order, step);
}

/* True if the same holds before and after the origin: u must cross it with a nonzero slope. */
static bool power_fits_around(const double *u, int order, double step, double bound) {
  return excursion(u, order, step) <= bound || (u[1] != 0.0 && is_monotone(u, order, step));
}

/* True if the operand is meaningful. NaN comes from an inactive piece of a function, and 1e200 or more from none. */
static bool matters(double u) {
  return fabs(u) < 1e200;
}

static void shorten(struct SeriesLimit *limit, const double *u, Fits *fits, double bound, const char *function) {
  if (limit->surrounds && !matters(u[0])) return;
  if (fits(u, limit->order, limit->step, bound)) return;
  double step = limit->step, long_step = step;
  for (int i = 0; i < TRIALS && !fits(u, limit->order, step, bound); i++) {
    long_step = step;
    step *= 0.125;
  }
  for (int i = 0; i < REFINEMENTS; i++) {
    double middle = sqrt(step * long_step);
    if (fits(u, limit->order, middle, bound)) step = middle;
    else long_step = middle;
  }
  limit->step = step;
  limit->function = function;
}

void series_limit_exponential(struct SeriesLimit *limit, const double *u, const char *function) {
  shorten(limit, u, excursion_fits, fmax(exponent_range, exponential_end - u[0]), function);
}

void series_limit_hyperbolic(struct SeriesLimit *limit, const double *u, const char *function) {
  shorten(limit, u, excursion_fits, exponent_range, function);
}

void series_limit_bounded(struct SeriesLimit *limit, const double *u, const char *function) {
  shorten(limit, u, excursion_fits, fmax(exponent_range, fabs(u[0]) + exponential_end), function);
}

void series_limit_tanh(struct SeriesLimit *limit, const double *u) {
  shorten(limit, u, excursion_fits, fmax(exponent_range, fabs(u[0]) - tanh_end), "tanh");
}

void series_limit_tangent(struct SeriesLimit *limit, const double *u) {
  double distance = pi / 2 - fabs(remainder(u[0], pi));
  shorten(limit, u, excursion_fits, approach * distance, "tan");
}

void series_limit_positive(struct SeriesLimit *limit, const double *u, const char *function) {
  shorten(limit, u, excursion_fits, approach * fabs(u[0]), function);
}

void series_limit_quotient(struct SeriesLimit *limit, const double *u, double share) {
  shorten(limit, u, excursion_fits, fmin(approach, share) * fabs(u[0]), "a division or power");
}

void series_limit_division(struct SeriesLimit *limit, const double *u, const double *numerator, double share) {
  int k = 0;
  while (k <= limit->order && numerator[k] == 0.0) k++;
  if (k <= limit->order) series_limit_quotient(limit, u, share);
}

void series_limit_root(struct SeriesLimit *limit, const double *u, double share) {
  if (!limit->crosses) shorten(limit, u, excursion_fits, fmin(approach, share) * fabs(u[0]), "a root");
}

void series_limit_whole_power(struct SeriesLimit *limit, const double *u, double share) {
  double bound = fmax(share * fabs(u[0]), negligible_base);
  if (limit->surrounds) shorten(limit, u, power_fits_around, bound, "a power");
  else if (!limit->crosses) shorten(limit, u, power_fits, bound, "a power");
}

void series_limit_power(struct SeriesLimit *limit, const double *u, double exponent) {
  double share = series_limit_share(exponent);
  if (exponent < 0.0) series_limit_quotient(limit, u, share);
  else if (exponent != floor(exponent)) series_limit_root(limit, u, share);
  else if (exponent > HIGHEST_WIDE_POWER) series_limit_whole_power(limit, u, share);
}

/* True if u moves away from 0 without a turning point, or cannot reach 0. */
static bool sign_fits(const double *u, int order, double step, double bound) {
  int first = 0;
  while (first < order && u[first] == 0.0) first++;
  bool leaves = u[first] * u[first == 0 ? 1 : first] > 0.0 && is_monotone(u, order, step);
  return leaves || excursion(u, order, step) <= bound;
}

void series_limit_sign(struct SeriesLimit *limit, const double *u, const char *function) {
  if (!limit->crosses) shorten(limit, u, sign_fits, approach * fabs(u[0]), function);
}

void series_limit_angle(struct SeriesLimit *limit, const double *y, const double *x) {
  if (limit->crosses || excursion(x, limit->order, limit->step) < x[0]) return;
  shorten(limit, y, excursion_fits, approach * fabs(y[0]), "atan2");
}
