/* Semismooth Newton method for impulses with Coulomb friction cones. */
#pragma once

#include "nonsmooth/cones/cones.h"

/* Returns the number of doubles of workspace for n rows. */
size_t cone_newton_work_count(size_t n);

/* Improves the impulses while each step reduces the residual by at least 10 %. Returns the residual, as a rate. */
double cone_newton(struct Cones *cones, double *work);
