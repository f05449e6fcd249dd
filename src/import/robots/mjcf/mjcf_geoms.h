/* <inertial> and <geom>: the inertia and the shapes of a body. */
#pragma once

#include "robots/mjcf/mjcf_values.h"

/* Sets the inertia and the shapes of a link, in its frame. Geoms of the world have no mass. */
void mjcf_read_body(struct Mjcf *mjcf, xmlNodePtr node, struct RobotLink *link);
