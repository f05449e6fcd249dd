/* All expressions that the generated code computes: what derivation gave, differentiated once more where needed. */
#pragma once

#include "interface/interface.h"
#include "mechanics/equations.h"
#include "mechanics/linearize.h"
#include "mechanics/mass_matrix/elimination.h"
#include "mechanics/switching.h"
#include "program/expressions/series_plan.h"
#include "program/expressions/weighted_gradient.h"
#include "algebra/node_list.h"

/*
 * d derivatives / d state by columns: column j has elements start[j] .. start[j + 1] - 1, their rows ascending. In
 * blocks of M that are factored at run time, the values are right sides: each column has all rows of such a block, or
 * none. Right sides of constraints are no elements, but apart.
 */
struct JacobianExpressions {
  size_t *start, *row;
  Node *value; /* NULL where derivatives along the directions of the state give the columns */
  size_t count;
  struct ConstraintSide *sides; /* by columns */
  size_t side_count;
  struct Elimination *factors; /* of a method that factors; NULL for none, and where full matrices are cheaper */
};

/* The right side of a constraint in a column of the Jacobian. */
struct ConstraintSide {
  size_t column, constraint;
  Node value;
};

/*
 * Right sides of K for what brings the state back to the constraints, one for each row: that of the positions rests on
 * the seed of the state, which holds by how much they have been moved.
 */
struct Corrections {
  Node *position, *velocity; /* in trees, of coordinates, the solutions */
  Node *pivot;               /* of each constraint in a tree, see articulated.h; ZERO of others */
  Node *slope;               /* of each constraint, see constraint_slopes() */
  Node *push; /* of each coordinate: what the seeds of the forces of contacts and frictions push along it */
};

struct Expressions {
  const struct Model *model;
  const struct Equations *equations;
  const struct Interface *interface;
  struct LinearSystem *linear;          /* NULL unless the solver is exact */
  struct SeriesPlan *series;            /* of the motion; NULL for exact and without coordinates */
  struct SeriesPlan *output_series;     /* NULL where outputs have no derivatives above the first, or are variables */
  struct SeriesPlan *watched_series;    /* of what events look at; NULL where nothing switches */
  Node *along;                          /* derivative of the accelerations, or right sides for it, of each row */
  Node *constraints_along;              /* of the elements of the constraints' J */
  struct Corrections corrections;       /* NULL without constraints */
  Node *unknowns, *unknowns_along;      /* of each row: the symbol of its acceleration or force, and of its seed */
  Node *rates_along;                    /* of the rates of the states behind the velocities */
  struct JacobianExpressions *jacobian; /* NULL unless the solver asks */
  Node *initial, *initial_along;        /* one for each state: its start where it follows, else ZERO */
  Node *result, *result_along;          /* one for each result; along is ZERO unless it is an output */
  struct WeightedGradient *weighted_gradient; /* NULL unless asked for, and where there is none */
};

/* What lagc can be asked for beside what every FMU has. */
struct Extras {
  bool adjoint; /* gradients by a reverse sweep */
};

/* Reports errors where the chosen solver does not fit the system; NULL then. */
struct Expressions *expressions_create(const struct Model *model, const struct Equations *equations,
                                       const struct Interface *interface, struct Extras extras,
                                       struct Diagnostics *diagnostics);

/* All nodes that are computed. */
struct NodeList expressions_targets(const struct Expressions *expressions);
