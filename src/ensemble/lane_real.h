/* include/real.h for lanes: with it, generated functions compute several runs at once. */
#ifndef REAL_H
#define REAL_H

#include "lanes.h"

typedef Lanes Real;
typedef Mask Condition;
#define BOTH(first, second) ((first) & (second))

#define REAL(number) LANES_OF(number)
#define CONSTANT(number) LANES_CONSTANT(number)
#define FUNCTION(name) lanes_##name
#define WHERE(condition, first, second) lanes_select(condition, LANES_OF(first), LANES_OF(second))

#define ANYWHERE(condition) any_lane(condition)

/* Lanes in which REQUIRE() failed since the caller last cleared it. */
extern _Thread_local Mask failed_lanes;
#define REQUIRE(condition, number) (failed_lanes |= ~(condition))

#endif
