/* Impulses of contacts whose frictions act in planes. */
#ifndef CONE_IMPULSES_H
#define CONE_IMPULSES_H

#include "contacts/pushes.h"

/* As find_impulses in struct FrictionLaws. */
bool cone_impulses_find(const struct Settlement *settlement, const struct Pushes *pushes, const double *rate,
                        double *impulse);

/* As has_other_impulses there: from several starts, so that it may find none where there are some. */
bool cone_impulses_have_others(const struct Settlement *settlement, const struct Pushes *pushes, const double *rate,
                               const double *impulse);

#endif
