/* All expressions that the generated code computes: the equations of motion and their derivatives. */
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
 * d derivatives / d state in compressed columns: column j has elements start[j] .. start[j + 1] - 1, rows
 * ascending. In rows of a block that is factored at run time, value has right sides. Each column has all rows of
 * the block or none. Right sides of constraint rows are in sides, not among the elements.
 */
struct JacobianExpressions {
  size_t *start, *row;
  Node *value; /* NULL: directional derivatives along each state give the columns */
  size_t count;
  struct ConstraintRightSide *right_sides; /* ascending by columns */
  size_t right_side_count;
  struct Elimination *factors; /* of a method that factors; NULL: full matrices are cheaper, or nothing is factored */
};

/* The right side of a constraint row in a column of the Jacobian. */
struct ConstraintRightSide {
  size_t column, constraint;
  Node value;
};

/*
 * Right sides of the projection onto the constraints, one for each row of K. position depends on the seed of the
 * state, which holds the corrections so far.
 */
struct Corrections {
  Node *position, *velocity; /* of coordinates in kinematic trees: the solutions themselves */
  Node *pivot;               /* of each constraint in a kinematic tree, see articulated.h; ZERO of others */
  Node *slope;               /* of each constraint: the length of its row of J, see constraint_slopes() */
  Node *impulse; /* of each coordinate: the generalized impulse of the contact and friction impulses in the seeds */
};

/*
 * The expressions that the generated functions compute. Directional derivatives are along the graph's seed symbols.
 */
struct Expressions {
  const struct Model *model;
  const struct Equations *equations;
  const struct Interface *interface;
  struct LinearSystem *linear;       /* NULL unless the method needs a linear system */
  struct SeriesPlan *series;         /* of the motion; NULL if the method takes no series */
  struct SeriesPlan *output_series;  /* NULL unless outputs have time derivatives above the first */
  struct SeriesPlan *watched_series; /* of the expressions that events depend on; NULL without events */
  /* of each row: directional derivative of its acceleration, or the right side for it in factored blocks */
  Node *along;
  Node *constraints_along;        /* directional derivatives of the elements of J */
  struct Corrections corrections; /* empty without constraints */
  /* of each row: the symbol of its acceleration or force, and of its directional derivative */
  Node *unknowns, *unknowns_along;
  Node *rates_along;                    /* directional derivatives of the rates of the first-order states */
  struct JacobianExpressions *jacobian; /* NULL unless the method needs it */
  struct NodeList initial; /* start values that are expressions of parameters, in the order of their variables */
  Node *initial_along;
  /* one for each result; result_along is ZERO unless it is an output or a calculated parameter */
  Node *result, *result_along;
  struct WeightedGradient *weighted_gradient; /* NULL unless requested, and if K is not symmetric */
};

/* Optional parts of an FMU. */
struct OptionalParts {
  bool adjoint; /* gradients in reverse mode */
};

/* Derives all expressions. Reports an error if the chosen solver does not fit the system, and returns NULL then. */
struct Expressions *expressions_create(const struct Model *model, const struct Equations *equations,
                                       const struct Interface *interface, struct OptionalParts extras,
                                       struct Diagnostics *diagnostics);

/* Returns all nodes that the generated code computes. */
struct NodeList expressions_targets(const struct Expressions *expressions);
