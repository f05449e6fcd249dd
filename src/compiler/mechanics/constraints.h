/*
 * Constraints at the levels of position, velocity and acceleration. Their forces F, the Lagrange multipliers, satisfy
 *
 *  M a + J^T F = Q + ...,   J a + (d2 constraint / dt2 at a = 0) = 0.
 *
 * J has the derivatives of holonomic constraints by the coordinates, of nonholonomic ones by the velocities. F is a
 * tension if the constraint is a distance less a length.
 */
#pragma once

#include "mechanics/mass_matrix/mass_elements.h"

/* The constraints of a model in its order; arrays have count elements. */
struct Constraints {
  size_t count;
  Node *position;           /* ZERO for nonholonomic ones */
  Node *velocity;           /* time derivative of position, or the nonholonomic constraint itself */
  Node *acceleration;       /* time derivative of velocity */
  Node *acceleration_rest;  /* the same at zero accelerations */
  struct Elements jacobian; /* J: constraints and free coordinates */
  /*
   * Coefficients of constraint forces in generalized forces, on the left side, such as the friction of a contact:
   * constraints and coordinates. They make K nonsymmetric, see nonsymmetric.h.
   */
  struct Elements nonsymmetric;
  struct Elements prescribed; /* elements of J for prescribed coordinates, which constraints do not accelerate */
};

/* Derives the constraints of the model at all three levels. */
struct Constraints *constraints_derive(const struct Model *model);

/* Returns the contribution of an element of J to J^T F. */
Node constraint_force_along(struct Graph *graph, const struct Elements *elements, size_t element, const Node *forces);

/* Returns the Euclidean norm of each constraint's row of J. */
Node *constraint_slopes(struct Graph *graph, const struct Constraints *constraints);

/* True if one of the nodes depends on a constraint force. */
bool depend_on_constraint_force(const struct Model *model, const Node *nodes, size_t count);
