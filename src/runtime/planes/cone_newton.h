/* Newton's method for the law of impacts with Coulomb's friction cone. */
#ifndef CONE_NEWTON_H
#define CONE_NEWTON_H

#include "planes/cones.h"

/* Returns the numbers of workspace for n rows. */
size_t cone_newton_work_count(size_t n);

/* Improves the impulses as long as the residual of the law decreases. Returns the residual, as a rate. */
double cone_newton(struct Cones *cones, double *work);

#endif
