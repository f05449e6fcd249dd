/* In which direction friction in a plane begins to slide. */
#ifndef PLANE_STARTS_H
#define PLANE_STARTS_H

#include "planes/plane_state.h"

/*
 * Turns the headings of all that are at rest and begin to slide until each accelerates along its own, *changed where any was not
 * so. *stays is one
 * that accelerates against it in each direction, so that it has to stick; plane_count for none. False where there are no
 * accelerations, or no headings.
 */
bool plane_headings_find(struct Settlement *settlement, bool *changed, size_t *stays);

#endif
