/* Inputs in constraints: prescribed motion. */
#ifndef GUIDES_H
#define GUIDES_H

#include "instance/instance.h"

/*
 * Makes each such input and its time derivatives, which are inputs too, one polynomial and its derivatives for the next
 * step: a constraint holds for positions, velocities and accelerations. The polynomial is the one set for the input, or
 * else follows from the derivatives.
 */
void guides_begin_step(struct Instance *instance);

#endif
