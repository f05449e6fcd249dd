/*
 * Constraints on the levels of position, velocity and acceleration. Their forces F are defined by
 *
 *   M a + J^T F = Q + ...,   J a + (d2 constraint / dt2 without accelerations) = 0,
 *
 * where J has the derivatives of the constraints by the coordinates, or of nonholonomic ones by the velocities: F is a
 * tension where the constraint is a distance less a length.
 */
#pragma once

#include "mechanics/mass_matrix/mass_elements.h"

struct Constraints {
  size_t count;
  Node *position;           /* ZERO of nonholonomic ones */
  Node *velocity;           /* its time derivative, or a nonholonomic constraint itself */
  Node *acceleration;       /* the time derivative of velocity */
  Node *acceleration_rest;  /* the same with 0 for the accelerations */
  struct Elements jacobian; /* J: constraints and coordinates */
  /*
   * What the force of a constraint adds to the left side of a coordinate's equation beside J^T, where a force follows from
   * it, as the friction of a contact: constraints and coordinates.
   */
  struct Elements oblique;
  struct Elements driven; /* the elements of driven coordinates, which no constraint moves, so that J has none */
};

struct Constraints *constraints_derive(const struct Model *model);

/* What one of the elements contributes to J^T forces. */
Node constraint_force_along(struct Graph *graph, const struct Elements *elements, size_t element, const Node *forces);

/* For each constraint the length of its row of J. */
Node *constraint_slopes(struct Graph *graph, const struct Constraints *constraints);

/* Whether a constraint force is among the symbols of one of the nodes. */
bool depend_on_constraint_force(const struct Model *model, const Node *nodes, size_t count);
