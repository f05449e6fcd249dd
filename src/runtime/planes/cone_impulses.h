/* Impulses of contacts whose frictions act in planes. */
#ifndef CONE_IMPULSES_H
#define CONE_IMPULSES_H

#include "contacts/pushes.h"

/* As find_impulses in struct FrictionLaws. */
bool cone_impulses_find(const struct Settlement *settlement, const struct Pushes *pushes, const double *rate,
                        double rounding, double *impulse);

#endif
