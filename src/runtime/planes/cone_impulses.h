/* Impulses of contacts with Coulomb friction in planes. */
#ifndef CONE_IMPULSES_H
#define CONE_IMPULSES_H

#include "contacts/contact_impulses.h"

/*
 * Implements find_impulses of struct FrictionLaws. impulse[] holds the last trial if none are found. False also if a
 * contact cannot be moved, or memory is missing.
 */
bool cone_impulses_find(const struct Resolution *resolution, const struct ContactImpulses *impulses, const double *rate,
                        double *impulse);

/* Implements has_other_impulses. It searches from several starts, and so may miss some. */
bool cone_impulses_have_others(const struct Resolution *resolution, const struct ContactImpulses *impulses,
                               const double *rate, const double *impulse);

#endif
