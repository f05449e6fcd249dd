/* Expressions for switching: the indicators of events, and the values that decide on the modes after one. */
#pragma once

#include "mechanics/equations.h"

/* The expressions for switching. Lists have the order of struct SwitchTable. */
struct SwitchingExpressions {
  const struct Branch **branches; /* those on which the motion depends */
  bool *holds_energy;             /* of each branch: the state determines its mode, and energies depend on it */
  bool *is_of_forces;             /* of each branch: its mode occurs in forces and outputs alone */
  size_t branch_count, assignment_count;
  size_t energy_count; /* kinetic, potential, and momenta if modes affect the kinetic one; 0 without holds_energy */
  /*
   * Indicators, as in indicator[] of struct SwitchTable: of contacts, the gap while open and the force while
   * closed. Those of frictions are the velocity while sliding, and the margin to the stiction while sticking.
   */
  Node *indicators;
  size_t indicator_count;
  Node *rounding_bounds; /* rounding error bounds of the indicators, see include/lagrangian.h */
  /*
   * Expressions in the indicators, for any modes: indicators of branches, gaps, velocities and stictions of frictions.
   */
  Node *watched;
  size_t watched_count;
  Node *values; /* value[] of struct SwitchTable */
  size_t value_count;
  Node *resting_sums; /* resting_sums of struct SwitchTable */
  size_t resting_sum_count;
  Node *ball_distances; /* ball_distances of struct SwitchTable */
  bool feels_forces;    /* a branch depends on a constraint force */
  bool has_last_signs;  /* some branches are those of events' expressions */
  bool friction_varies; /* the sliding force of a friction is not constant */
  size_t *timed;        /* branches of time, parameters and modes: first those that are affine in time */
  size_t timed_count, affine_count;
  size_t sample_count; /* number of sampling events */
  bool *rests; /* [friction * contacts + contact]: the friction depends on the contact force; NULL if none does */
};

/* Returns the expressions, which contain acceleration symbols; NULL if nothing switches. */
struct SwitchingExpressions *switching_derive(const struct Model *model, const struct Equations *equations);

/* Replaces the modes of branches by the signs of their indicators, as for results, which cause no events. */
Node without_branches(const struct Model *model, Node node);

/* Returns the expression as pages show it, without the modes of branches and of velocities at rest. */
Node as_written(const struct Model *model, Node node);
