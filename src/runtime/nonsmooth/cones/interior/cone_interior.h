/* Interior-point method for impulses, or forces, with Coulomb friction cones. */
#pragma once

#include "nonsmooth/cones/cones.h"

/* Returns the number of doubles of workspace for n rows. */
size_t cone_interior_work_count(size_t n);

/*
 * Finds impulses that fulfil the law, from no start; ends at the residual `enough`. is_centered: where several fulfil
 * it, contacts press and frictions stick as far inside of their limits as they can. Returns the residual of the best
 * impulses found, relative to the largest one.
 */
double cone_interior(struct Cones *cones, double enough, bool is_centered, double *work);

/* These functions, for the switch tables of systems with frictions on contacts or in planes. */
extern const struct ConePath cone_path;
