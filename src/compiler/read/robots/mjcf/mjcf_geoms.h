/* The <inertial> and the <geom>s of a body of MJCF: what it weighs, and what it touches with. */
#pragma once

#include "read/robots/mjcf/mjcf_values.h"

/*
 * Gives the link the inertia of its body and the shapes that collide, in its frame.
 * The geoms of the world weigh nothing.
 */
void mjcf_read_body(struct Mjcf *mjcf, xmlNodePtr node, struct Link *link);
