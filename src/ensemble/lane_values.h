/* What the FMU's variables are in lanes. */
#ifndef LANE_VALUES_H
#define LANE_VALUES_H

#include "ensemble.h"
#include "lane_events.h"

bool lane_values_can_vary(const struct ScalarVariable *variable);
bool lane_values_can_tell(const struct ScalarVariable *variable);

/*
 * What is asked at a time of each lane and at steps->state, for those that have reached it: their runs' and times' places are
 * given by lane.
 * Returns the lanes in which something is not finite.
 */
Mask lane_values_tell(const struct Ensemble *ensemble, struct LaneEvents *events, Lanes time, Mask is_reached,
                      const size_t *run, const size_t *place);

#endif
