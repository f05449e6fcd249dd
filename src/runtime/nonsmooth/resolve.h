/* Event resolution: the modes and the state after an event (resolve.c). */
#pragma once

#include "instance/event_laws.h"

/*
 * Brings the modes into agreement with the state at a time. Impacts and events may change the state. indicator: the one
 * whose sign changed, for AT_EVENT. Sets *changed if anything changed. Returns NULL, or the reason why the motion
 * cannot continue, after logging the cause.
 */
const char *resolve(struct Instance *instance, double time, double *state, enum Occasion occasion, size_t indicator,
                    bool *changed);

/*
 * Does the same for an expression or a state that has changed at this time. False if the motion cannot continue there;
 * then the modes stay, and nothing is logged. Sets *switches if other constraints of contacts or frictions are active.
 */
bool resolve_or_restore(struct Instance *instance, double time, double *state, bool *switches);

/* Logs which contact friction jams at a state where the motion ends; false if it jams none. */
bool resolve_explain(struct Instance *instance, double time, double *state);
