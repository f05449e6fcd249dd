/* Semismooth Newton method for impulses with Coulomb friction cones. */
#pragma once

#include "nonsmooth/cones/cones.h"

/* Returns the number of doubles of workspace for n rows. */
size_t cone_newton_work_count(size_t n);

/*
 * Shortest part of a step that is taken. Far from a solution only whole steps are: damped ones may lead anywhere, and
 * sweeps lead nearer. At the end of a path damped ones find the pieces where an impulse and its rate both are nearly 0.
 */
static const double whole_step = 1.0, damped_step = 1.0 / 64.0;

/*
 * Improves the impulses while each step, or a part of it of at least shortest_step, reduces the residual by 10 % of that
 * part. Returns the residual, as a rate.
 */
double cone_newton(struct Cones *cones, double shortest_step, double *work);
