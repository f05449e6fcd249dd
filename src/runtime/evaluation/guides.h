/* Inputs that stand in constraints, which move coordinates from outside. */
#ifndef GUIDES_H
#define GUIDES_H

#include "instance/instance.h"

/*
 * Over the step to come, each of them and its time derivatives become one polynomial and its derivatives, since a
 * constraint holds on all levels: the polynomial that was set for the input, or else the one that its derivatives tell.
 */
void guides_begin_step(struct Instance *instance);

#endif
