/*
 * Pointer interaction of a page. Inputs give the position of the pointer and the grabbed point of a body; a spring
 * force acts on each body.
 */
#pragma once

#include "read/context/attributes.h"

/* Adds the inputs pull.x, ... and pull.of.BODY, and the forces: on at most MOST_PULLED bodies, evenly chosen. */
void add_pointer_interaction(struct Reader *reader);
