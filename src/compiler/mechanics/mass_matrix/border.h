/* What constraints add to the mass matrix. */
#pragma once

#include "mechanics/mass_matrix/mass_elements.h"

/*
 * What borders M: the rows J of count constraints, and what their forces add beside J^T; both of constraints and coordinates.
 */
struct Border {
  size_t count;
  const struct Elements *jacobian, *oblique;
};
