/* What tells whether an implicit method would go further in a step. */
#ifndef STIFFNESS_H
#define STIFFNESS_H

#include "methods/taylor.h"

/*
 * How many times as far as the last step of the Taylor series a step of an implicit method may lead, whose error is of
 * this order and to be as small as the tolerance. Small where the motion itself is as fast as the step is short.
 */
double stiffness_promise(const struct Taylor *taylor, int order, double tolerance);

/*
 * A bound of the fastest rate of the system, in 1/s, from the elements of its Jacobian as lagrangian.implicit.jacobian() gives
 * them; state_count numbers of workspace.
 */
double stiffness_rate(const double *jacobian, double *work);

#endif
