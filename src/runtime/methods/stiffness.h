/* Stiffness: the step that an implicit method could take. */
#pragma once

#include "methods/taylor.h"

/*
 * Returns the predicted step of an implicit method with an error of this order, as a multiple of the last Taylor step.
 * 0 if the motion itself, and not a fast mode, limits the Taylor step.
 */
double predicted_stiffness(const struct Taylor *taylor, int order, double tolerance);

/*
 * Returns an upper bound of the fastest rate in 1/s, from the Jacobian in the order of lagrangian.implicit.pattern.
 * work: state_count doubles of workspace.
 */
double stiffness_rate(const double *jacobian, double *work);
