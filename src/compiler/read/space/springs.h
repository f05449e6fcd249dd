/* <spring>: a spring and a damper along the line between two points. Its length and force are named expressions. */
#pragma once

#include "read/context/attributes.h"

/* Collects NAME.length and NAME.force of a spring with a name. */
void collect_spring(struct Reader *reader, xmlNodePtr node);

/* Reads one of the two: the length in m, or the force in N, positive in tension. */
struct Quantity read_spring_value(struct Reader *reader, xmlNodePtr node, const char *component);

/* Adds k (l - l0)^2 / 2 to the potential and c (dl/dt)^2 / 2 to the dissipation. */
void read_spring(struct Reader *reader, xmlNodePtr node);
