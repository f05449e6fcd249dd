/* The constraint block of the system K x = b. */
#pragma once

#include "mechanics/mass_matrix/mass_elements.h"

/*
 * The rows J of count constraints, and the coefficients of their forces in generalized forces in addition to J^T; both
 * of constraints and coordinates.
 */
struct ConstraintBlock {
  size_t count;
  const struct Elements *jacobian, *nonsymmetric;
};
