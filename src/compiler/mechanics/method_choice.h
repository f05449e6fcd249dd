/*
 * Choice of the method that solves the equations of a system.
 *
 * A linearized system takes "exact", the matrix exponential. A system with a kink that no Taylor series shows takes
 * "erk", an explicit Runge-Kutta method. One that may be stiff takes "auto", which switches between Taylor series and
 * Radau IIA at run time. All others take "taylor".
 */
#pragma once

#include "mechanics/equations.h"

/* Returns the author's choice, or else the method that fits the equations; NULL without coordinates and states. */
const struct Method *method_of(const struct Model *model, const struct Equations *equations);
