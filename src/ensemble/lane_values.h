/* Values of the FMU's variables in lanes. */
#pragma once

#include "ensemble.h"
#include "lane_events.h"

/* True if a run can vary, or sample, the variable. */
bool lane_values_can_vary(const struct ScalarVariable *variable);
bool lane_values_can_report(const struct ScalarVariable *variable);

/*
 * Samples the recorded variables at a time of each lane and at steps->state, in the reached lanes. run, slot: of each
 * lane, the run and the index of the time. Returns the lanes in which a value is not finite.
 */
Mask lane_values_report(const struct Ensemble *ensemble, struct LaneEvents *events, Lanes time, Mask is_reached,
                        const size_t *run, const size_t *slot);
