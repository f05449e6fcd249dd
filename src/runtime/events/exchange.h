/*
 * Events for an importer that integrates. It tries states beyond the end of a piece before it knows of the event there.
 * The piece may have no value there, as (-y)^1.5 for y > 0: it then gets the value at the end of the piece.
 */
#ifndef EXCHANGE_H
#define EXCHANGE_H

#include "instance/event_laws.h"

/* Implement the functions of these names in struct EventLaws. */
bool exchange_return_to_domain(struct Instance *instance, struct Point *point);
bool exchange_indicators(struct Instance *instance, double *value);
bool exchange_is_due(struct Instance *instance);
const char *exchange_resolve(struct Instance *instance);

#endif
