/* The equations of motion, and all that is computed beside them. */
#pragma once

#include "algebra/node_list.h"
#include "mechanics/constraints.h"
#include "mechanics/mass_matrix/inertia.h"

struct SwitchingExpressions;

/* What follows from a model, which stays as it is. */
struct Equations {
  size_t count; /* coordinates */
  struct Constraints *constraints;
  struct Inertia *inertia;
  /*
   * Of each row of inertia.h, coordinates and then constraints; a: accelerations and forces of constraints. residual is
   * K a - right_side with symbols for a; acceleration has expressions in unrolled blocks, and the symbols in others.
   */
  Node *right_side, *residual, *acceleration;
  /* Accelerations are given as such (linearised systems): M is 1 above, and inertia is M at the point. */
  bool explicit_form;
  struct NodeList
      rates; /* of the model's states behind the velocities; they hold no accelerations of unrolled blocks */
  /* Of the non-conservative forces: sum Q_i v_i, F . dr/dt of Cartesian ones, and of what drives and moves. */
  Node power;
  Node stated_power;                            /* the same, which may hold the acceleration symbols */
  Node kinetic, potential, total;               /* energies, see energies.h */
  Node *outputs;                                /* of the model */
  Node *reactions;                              /* of the model; they may hold the acceleration symbols */
  Node *places;                                 /* of the model; they too */
  const struct Method *method;                  /* that solves them; NULL without coordinates */
  const struct SwitchingExpressions *switching; /* NULL where nothing switches */
};

/* Equations of a model without anything derived yet. */
struct Equations *equations_create(const struct Model *model);

/* Reports coefficients that are not finite: of sums and products too large for numbers, and of a point at a pole. */
void equations_check_finite(const struct Model *model, const struct Equations *equations,
                            struct Diagnostics *diagnostics);

/* Whether the row belongs to a block that is solved at run time, by ldlt.h. */
bool is_looped(const struct Equations *equations, size_t row);

/* True if rates of states hold accelerations or forces that are found at run time. */
bool rates_use_unknowns(const struct Graph *graph, const struct Equations *equations);

/* How many rows there are. */
size_t row_count(const struct Equations *equations);
