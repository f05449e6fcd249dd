/*
 * Addition theorems from right to left, where two terms become one:
 *
 *  cos a cos b + sin a sin b = cos(a - b),   sin a cos b - cos a sin b = sin(a - b),   likewise for a + b,
 *  sin^2 a + cos^2 a = 1,   1 - cos^2 a = sin^2 a.
 *
 * Each step removes a term, so that the search ends. Also, x sign(x) = abs(x).
 */
#pragma once

#include "display/terms.h"

void apply_addition_theorems(struct Atoms *atoms, struct Terms *terms);
