/*
 * Events for an importer that integrates. It tries states beyond the end of a piece before it knows of the event there.
 * The piece may have no value there, as sqrt(max(0, h)) for h < 0: they then get the value of the piece there.
 */
#pragma once

#include "instance/event_laws.h"

/* Implement the functions of these names in struct EventLaws. */
bool exchange_change_pieces(struct Instance *instance, const struct Point *point);
void exchange_return_pieces(struct Instance *instance);
bool exchange_indicators(struct Instance *instance, double *value);
bool exchange_is_due(struct Instance *instance);
const char *exchange_resolve(struct Instance *instance);
