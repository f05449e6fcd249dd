/* Time steps over events that cannot be found one by one. */
#pragma once

#include "instance/instance.h"

/*
 * Moves event_state on from *time by time steps (time_step.h), and sets *time. Behind the last one modes agree with the
 * state; they are tried from `until` on. *share: that of the last step, 0 for none; each further step is longer, up to
 * *longest, in s. False if there are no modes up to the end, or if steps could pass an <event>.
 */
bool step_over_events(struct Instance *instance, double until, double end, double *share, double *time,
                      double *longest);
