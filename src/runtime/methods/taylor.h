/* The series of the Taylor solver, and their values within a step. */
#ifndef TAYLOR_H
#define TAYLOR_H

#include <math.h>

#include "instance/instance.h"
#include "methods/taylor_rule.h"

/* What the situation holds for this solver, beside the span of its last step; they tell all that a step depends on. */
struct TaylorSaved {
  double reach; /* how far from the origin the series is right, the length of the last step; 0 for no series yet */
  int64_t order;
  /* double low[state_count]: what rounding left of the state at origin; Series x[state_count] */
};

/* Steps of one kind that hardly move the system; the kind goes on where a thousand of them do not. */
struct Crawl {
  int steps;
  double path;
};

struct Taylor {
  struct TaylorSaved *saved;
  struct Span *span; /* of the last step; its start is the origin of the series */
  double *low;
  Series *x;            /* coefficients of the state; x[i][0] is the state at origin */
  Series *input, *work; /* coefficients of the inputs, workspace of lagrangian.taylor.series */
  /* Of state_count elements each, where is_measured: the changes of the state over the reach, and d state / dt there. */
  double *term, *derivative;
  double *unit;           /* state_count: 1 / taylor_scale(), as the series began */
  bool is_measured;       /* lagrangian.taylor.start was called last for the end of the reach */
  bool is_limited;        /* the step is short for another reason than the size of its coefficients */
  bool crosses;           /* the step crosses a point where a function has no series */
  struct SeriesRule rule; /* that the tolerance asks for */
  struct Crawl regular, crossing;
};

/* The size of a state variable at the origin, or its nominal value where that is larger. */
static inline double taylor_scale(const struct Taylor *taylor, size_t i) {
  double size = fabs(taylor->x[i][0]);
  return size < lagrangian.steps.nominal[i] ? lagrangian.steps.nominal[i] : size;
}

/* From Horner's sums of even and odd powers, with the first term where these begin with the second. */
static inline double taylor_end_of_change(const double *x, int64_t j, Pair sum, double s) {
  double change = (pair_second(sum) * s + pair_first(sum)) * s;
  return j == 1 ? (change + x[1]) * s : change;
}

/*
 * The change of state variable i from the origin to s after it, by Horner's rule for even and odd powers apart, which
 * are a pair.
 */
static inline double taylor_change(const struct Taylor *taylor, size_t i, double s) {
  const double *x = taylor->x[i], square = s * s;
  int64_t j = taylor->saved->order;
  Pair sum = pair_at(x + j - 1);
  for (j -= 2; j > 1; j -= 2) sum = pair_sum(pair_multiple(sum, square), pair_at(x + j - 1));
  return taylor_end_of_change(x, j, sum, s);
}

/* The same at three times at once, none of which waits for another. */
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

/* What the tolerance asks for. */
struct SeriesRule taylor_rule(const struct Instance *instance);

#endif
