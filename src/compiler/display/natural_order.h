/*
 * The order of terms in a sum: accelerations, constraint forces, squares of velocities, velocities, other terms with
 * coordinates, inputs. Terms that differ in parameters alone become one, whose coefficient is a sum of
 * parameters: (m1 + m2)*l1^2. Terms with the same acceleration become one likewise.
 */
#pragma once

#include "display/terms.h"

/* Returns the sum of the terms as text; texts has the texts of the atoms. */
char *sum_in_natural_order(const struct Atoms *atoms, const struct Terms *terms, const char *const *texts);
