/* State of the Taylor method, and the evaluation of its polynomials within a step. */
#pragma once

#include <math.h>

#include "instance/instance.h"
#include "methods/taylor_rule.h"

/* This method's part of the snapshot. Together with the span of the last step it determines the next step. */
struct TaylorSaved {
  double interval; /* length of the last step, for which the series is valid; 0 if there is no series yet */
  int64_t order;
  /* Followed by double low[state_count], the rounding error of the state at the origin, and Series x[state_count]. */
};

/* Stagnation counter: steps of one kind, and their path in units of the scales; reset every STAGNATION_STEPS steps. */
struct Stagnation {
  int steps;
  double path;
};

/*
 * Memory of the method. saved, low and x are in the snapshot; the series is valid from the start of span for
 * saved->interval seconds.
 */
struct Taylor {
  struct TaylorSaved *saved;
  struct Span *span; /* of the last step; its start is the origin of the series */
  double *low;
  Series *x;            /* coefficients of the state; x[i][0] is the state at the origin */
  Series *input, *work; /* coefficients of the inputs; workspace of lagrangian.taylor.series */
  /* state_count each, valid if is_measured: the changes of the state over the step, and d state / dt at its end. */
  double *term, *derivative;
  double *unit;           /* state_count: 1 / taylor_scale() at the origin */
  bool is_measured;       /* term, derivative and work are those of the end of the step */
  bool is_limited;        /* something other than the size of the coefficients limits the step */
  bool crosses;           /* the step crosses a point at which a function has no series */
  struct SeriesRule rule; /* order and step margin for the tolerance */
  struct Stagnation regular, crossing;
};

/* Returns the scale of state variable i: its absolute value at the origin, at least its nominal value. */
static inline double taylor_scale(const struct Taylor *taylor, size_t i) {
  double size = fabs(taylor->x[i][0]);
  return size < lagrangian.steps.nominal[i] ? lagrangian.steps.nominal[i] : size;
}

/* Combines Horner's sums over even and odd powers into the change of the state. At odd orders (j = 1) it adds x[1]. */
static inline double taylor_end_of_change(const double *x, int64_t j, Pair sum, double s) {
  double change = (pair_second(sum) * s + pair_first(sum)) * s;
  return j == 1 ? (change + x[1]) * s : change;
}

/* Returns the change of state variable i from the origin to s after it, by Horner's rule for even and odd powers. */
static inline double taylor_change(const struct Taylor *taylor, size_t i, double s) {
  const double *x = taylor->x[i], square = s * s;
  int64_t j = taylor->saved->order;
  Pair sum = pair_at(x + j - 1);
  for (j -= 2; j > 1; j -= 2) sum = pair_sum(pair_multiple(sum, square), pair_at(x + j - 1));
  return taylor_end_of_change(x, j, sum, s);
}

/* Computes the same at three times s[3], with three independent chains of operations. */
static inline void taylor_three_changes(const struct Taylor *taylor, size_t i, const double *s, double *change) {
  const double *x = taylor->x[i], squares[] = {s[0] * s[0], s[1] * s[1], s[2] * s[2]};
  int64_t j = taylor->saved->order;
  Pair first = pair_at(x + j - 1), second = first, third = first;
  for (j -= 2; j > 1; j -= 2) {
    Pair next = pair_at(x + j - 1);
    first = pair_sum(pair_multiple(first, squares[0]), next);
    second = pair_sum(pair_multiple(second, squares[1]), next);
    third = pair_sum(pair_multiple(third, squares[2]), next);
  }
  change[0] = taylor_end_of_change(x, j, first, s[0]);
  change[1] = taylor_end_of_change(x, j, second, s[1]);
  change[2] = taylor_end_of_change(x, j, third, s[2]);
}

/* Returns the order and the step margin for the tolerance of the simulation. */
struct SeriesRule taylor_rule(const struct Instance *instance);
