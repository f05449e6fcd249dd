/* How many degrees of freedom a system has, and what its motion conserves. */
#ifndef FREEDOM_H
#define FREEDOM_H

#include "mechanics/equations.h"

/*
 * Returns the rank of the Jacobian of the permanent constraints at the start values, without those of contacts and
 * frictions. Uses Gaussian elimination with complete pivoting.
 */
size_t constraint_rank(const struct Model *model, const struct Equations *equations);

/* Returns the number of these constraints. */
size_t permanent_constraint_count(const struct Model *model);

/* True if no constraint, contact or friction acts on the coordinate. */
bool is_unconstrained(const struct Equations *equations, size_t coordinate);

#endif
