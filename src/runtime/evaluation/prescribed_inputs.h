/* Inputs in constraints: prescribed motion. */
#ifndef PRESCRIBED_INPUTS_H
#define PRESCRIBED_INPUTS_H

#include "instance/instance.h"

/*
 * Prepares the inputs of constraints for the next step. A constraint also holds for velocities and accelerations. So
 * each of these inputs and its time derivatives, which are inputs too, become one polynomial and its derivatives. It is
 * the polynomial that was set for the input, or else follows from the derivatives.
 */
void prescribed_inputs_begin_step(struct Instance *instance);

#endif
