/* Other outcomes of an impact, with frictions along lines. */
#pragma once

#include "nonsmooth/contacts/contact_impulses.h"

/*
 * True if other impulses also fulfil the complementarity conditions of the impact, as has_other_impulses of struct
 * FrictionLaws. Tries all combinations of contacts that open or press and frictions that stick or slide. False for more
 * than eight impulses, which have too many combinations.
 */
bool impact_has_others(const struct Resolution *resolution, const struct ContactImpulses *impulses, const double *rate,
                       const double *impulse);
