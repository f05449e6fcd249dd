/*
 * What an importer asks that integrates by itself. It tries states beyond the end of a piece, before it knows of the event
 * there, and the piece may have no value, as (-y)^1.5 where y > 0: it gets the value at that end.
 */
#ifndef EXCHANGE_H
#define EXCHANGE_H

#include "instance/event_laws.h"

/* The functions of these names in struct EventLaws. */
bool exchange_come_back(struct Instance *instance, struct Point *point);
bool exchange_indicators(struct Instance *instance, double *value);
bool exchange_is_due(struct Instance *instance);
const char *exchange_settle(struct Instance *instance, bool *changed);

#endif
