/* What an FMU must know to switch: the indicators of events, and all that decides on the modes behind one. */
#pragma once

#include "mechanics/equations.h"

struct SwitchingExpressions {
  const struct Branch **branches; /* those that the motion rests on */
  bool *holds_energy; /* of each branch: whether the state decides by it on an energy, which must not jump there */
  size_t branch_count, assignment_count;
  size_t energy_count; /* where a branch holds any: kinetic, potential, and momenta where it holds the first; else 0 */
  /*
   * As indicator[] of struct SwitchTable holds them, see include/lagrangian.h: of contacts, the gap while they are open and
   * the force while they are closed; of frictions, the velocity while they slide and what is left of the stiction while they
   * stick.
   */
  Node *indicators;
  size_t indicator_count;
  Node *roundings; /* of the indicators, see include/lagrangian.h */
  /* What the indicators look at, whatever the modes: those of branches, gaps, velocities and stictions of frictions. */
  Node *watched;
  size_t watched_count;
  Node *values; /* as value[] of struct SwitchTable holds them, see include/lagrangian.h */
  size_t value_count;
  bool feels_forces;    /* some branch turns by the force of a constraint */
  bool has_sides;       /* of expressions of events, among the branches */
  bool friction_varies; /* some friction slides with a force that is not constant */
  size_t *timed;        /* the branches whose next zero is a known time: affine in time, else of parameters and modes */
  size_t timed_count;
  size_t sample_count; /* of the events */
  bool *
      rests; /* of each friction, and in it of each contact: the friction follows from its force; NULL where none does */
};

/* NULL for a system that does not switch. Both hold the acceleration symbols. */
struct SwitchingExpressions *switching_derive(const struct Model *model, const struct Equations *equations);

/* The node with the modes of branches replaced by the signs that they stand for, as results that no event waits for. */
Node without_branches(const struct Model *model, Node node);
