/* Active set method for impulses of contacts without friction. */
#pragma once

#include "nonsmooth/cones/cones.h"

/* Returns the number of doubles of workspace for n contacts. */
size_t active_set_work_count(size_t n);

/* True if the problem has contacts alone, and a symmetric matrix: then active_set_find() solves it. */
bool active_set_applies(const struct Cones *cones);

/* Finds the impulses. They always exist; up to rounding, the rates do not depend on where the method begins. */
void active_set_find(struct Cones *cones, double *work);
