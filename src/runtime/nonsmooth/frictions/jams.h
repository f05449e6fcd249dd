/* Modes of frictions at rest whose forces follow from constraint forces, by Coulomb's law. */
#pragma once

#include "nonsmooth/resolution.h"

/*
 * Sets the modes of frictions at rest, and of branches that have switched, to those of the only consistent motion;
 * once an event resolution. Returns false if there is none, if there are too many combinations, or if no branch
 * depends on a force. Also returns false if there are several motions, which it logs.
 */
bool jams_resolve(struct Resolution *resolution);
