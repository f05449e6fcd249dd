/* State of the Taylor method. */
#pragma once

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
 * Memory of the method. saved, step.low and step.x are in the snapshot; the series is valid from the start of span for
 * saved->interval seconds.
 */
struct Taylor {
  struct TaylorStep step; /* state and rate are parts of instance->work */
  struct Instance *instance;
  struct TaylorSaved *saved;
  struct Span *span;      /* of the last step; its start is the origin of the series */
  Series *input, *work;   /* coefficients of the inputs; workspace of lagrangian.taylor.series */
  bool is_measured;       /* term, derivative and work are those of the end of the step */
  bool crosses;           /* the step crosses a point at which a function has no series */
  struct SeriesRule rule; /* order and step margin for the tolerance */
  struct Stagnation regular, crossing;
};

/* Returns the order and the step margin for the tolerance of the simulation. */
struct SeriesRule taylor_rule(const struct Instance *instance);
