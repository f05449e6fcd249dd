/*
 * The modes behind an event. Rounds of the following go on until one changes nothing: contacts; branches of pieces; frictions
 * that stick or slip; the sides of the expressions of events; and these events, each of which happens when its condition comes
 * to hold.
 */
#ifndef SETTLE_H
#define SETTLE_H

#include "instance/event_laws.h"

/* As in struct EventLaws. */
const char *settle(struct Instance *instance, double time, double *state, enum Occasion occasion, size_t indicator,
                   bool *changed);

/* Logs which contact friction jams at a state where the motion ends; false where it jams none. */
bool settle_explain(struct Instance *instance, double time, double *state);

#endif
