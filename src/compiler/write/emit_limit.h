/* C that shortens a Taylor step where an elementary function could hide something; see series_limit.h. */
#ifndef EMIT_LIMIT_H
#define EMIT_LIMIT_H

#include "write/recurrences.h"

/* Marks the nodes whose coefficients limit() will read as arrays; before rows are assigned. Returns how many there are. */
size_t limit_mark_rows(struct SeriesWriter *writer);

/* Writes limit(), which reads the rows that series() has filled. */
void emit_limit(struct Emitter *emitter, struct SeriesWriter *writer);

#endif
