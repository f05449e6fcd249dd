/* Whether an impact could come out in another way, where frictions act along lines. */
#ifndef IMPACT_OUTCOMES_H
#define IMPACT_OUTCOMES_H

#include "contacts/pushes.h"

/*
 * As has_other_impulses in struct FrictionLaws: all combinations of what leaves, presses, sticks and slides are tried. False for
 * more than eight pushes, of which too many would have to be.
 */
bool impact_has_others(const struct Settlement *settlement, const struct Pushes *pushes, const double *rate,
                       const double *impulse);

#endif
