/* The equations of motion, and the expressions computed with them. */
#pragma once

#include "algebra/node_list.h"
#include "mechanics/constraints.h"
#include "mechanics/mass_matrix/inertia.h"

struct SwitchingExpressions;

/* Equations derived from a model. */
struct Equations {
  size_t count; /* number of coordinates */
  struct Constraints *constraints;
  struct Inertia *inertia;
  /*
   * For each row of inertia.h, coordinates and then constraints, with unknowns a: accelerations and constraint forces.
   * residual is K a - right_side with symbols for a. acceleration holds expressions for the unknowns of unrolled
   * blocks, and the symbols of others.
   */
  Node *right_side, *residual, *acceleration;
  /* Linearized: the accelerations are explicit. residual has M = 1; inertia is M at the operating point. */
  bool explicit_form;
  struct NodeList rates; /* of the model's first-order states, without unknowns of unrolled blocks */
  /*
   * Power of the nonconservative forces: sum of Q_i v_i, F . dr/dt of Cartesian forces, and that of the driving forces.
   */
  Node power;
  Node stated_power;                            /* the same; may contain acceleration symbols */
  Node kinetic, potential, total;               /* energies, see energies.h */
  Node *outputs;                                /* of the model */
  Node *reactions;                              /* of the model; may contain acceleration symbols */
  Node *element_variables;                      /* of the model; may contain acceleration symbols */
  const struct Method *method;                  /* solver; NULL without coordinates and states */
  const struct SwitchingExpressions *switching; /* NULL if nothing switches */
};

/* Returns the equations of a model before their derivation, with its constraints. */
struct Equations *equations_create(const struct Model *model);

/* Reports coefficients that are not finite, by overflow or at a pole. */
void equations_check_finite(const struct Model *model, const struct Equations *equations,
                            struct Diagnostics *diagnostics);

/* True if the row belongs to a block that is solved numerically at run time. */
bool is_looped(const struct Equations *equations, size_t row);

/* True if rates of first-order states contain accelerations or constraint forces that are computed at run time. */
bool rates_use_unknowns(const struct Graph *graph, const struct Equations *equations);

/* Returns the number of rows: coordinates and constraints. */
size_t row_count(const struct Equations *equations);
