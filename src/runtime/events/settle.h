/*
 * The modes behind an event. Rounds of the following go on until one changes nothing: contacts; branches of pieces; frictions
 * that stick or slip; the sides of the expressions of events; and these events, each of which happens when its condition comes
 * to hold.
 */
#ifndef SETTLE_H
#define SETTLE_H

#include "instance/event_laws.h"

/*
 * Brings the modes into agreement with the state at a time, with impacts and events, which change the state. indicator is the one
 * whose sign changed, for AT_EVENT. changed tells whether anything did. NULL, or the reason why the motion cannot go on, after
 * logging what is to blame.
 */
const char *settle(struct Instance *instance, double time, double *state, enum Occasion occasion, size_t indicator,
                   bool *changed);

/* Logs which contact friction jams at a state where the motion ends; false where it jams none. */
bool settle_explain(struct Instance *instance, double time, double *state);

#endif
