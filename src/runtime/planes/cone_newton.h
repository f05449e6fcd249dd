/* Newton's method for the law of impacts with Coulomb's cone. */
#ifndef CONE_NEWTON_H
#define CONE_NEWTON_H

#include "planes/cones.h"

/* Numbers of workspace for n rows. */
size_t cone_newton_work_count(size_t n);

/* Goes on from the impulses as long as they come nearer to the law. Returns how far they are from it, as a rate. */
double cone_newton(struct Cones *cones, double *work);

#endif
