/* Impulses and forces of contacts with Coulomb friction. */
#pragma once

#include "nonsmooth/cones/impulses.h"
#include "nonsmooth/resolution.h"

/*
 * Finds the impulses of an impact, from the rates before it, those of contacts times 1 + e. False if none are found;
 * impulse[] then holds the last trial. False, too, if no impulse moves one of the contacts, or memory is missing.
 */
bool cone_impulses_find(const struct Resolution *resolution, const struct ContactImpulses *impulses, const double *rate,
                        double *impulse);

/* Continues from impulses of other rates by Newton's method. False if that fails. */
bool cone_impulses_continue(const struct Resolution *resolution, const struct ContactImpulses *impulses,
                            const double *rate, double *impulse);

/*
 * Finds forces at rest: impulses of the same law, with the accelerations as rates. Where several sets of forces fulfil
 * it, these have a margin to their limits. error: twice the residual, a bound of the accelerations' errors. False if
 * none are found.
 */
bool cone_forces_find(const struct Resolution *resolution, const struct ContactImpulses *impulses, const double *rate,
                      double *force, double *error);

/* Finds those that are near the given ones. */
bool cone_forces_continue(const struct Resolution *resolution, const struct ContactImpulses *impulses,
                          const double *rate, double *force, double *error);

/*
 * True if other impulses also fulfil the law, with another motion and no gain of energy. It searches from several
 * starts, and so may miss some.
 */
bool cone_impulses_have_others(const struct Resolution *resolution, const struct ContactImpulses *impulses,
                               const double *rate, const double *impulse);
