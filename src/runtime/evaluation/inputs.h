/* Inputs as polynomials of time over a communication step. */
#pragma once

#include "instance/instance.h"

/* Computes the Taylor coefficients 0 to INPUT_ORDER at time of input i, a polynomial that starts at fmu_state->time. */
void expand_input(const struct Instance *instance, size_t i, double time, double *coefficient);

/* Computes input[input_count] at time. */
void evaluate_inputs(const struct Instance *instance, double time, double *input);

/* Moves the start of the inputs' polynomials to a later time in the communication step. */
void evaluate_advance_inputs(struct Instance *instance, double time);

/*
 * Keeps the inputs' polynomials within min and max over a step of this length. One that leaves them is replaced by
 * the straight line to its value at the end, or to the limit that this value exceeds. An input that prescribes a
 * motion stays, as its derivatives are velocities of bodies: returns false after logging one that leaves its
 * limits.
 */
bool limit_inputs(struct Instance *instance, double length);
