/* Checks for events that cannot happen. */
#pragma once

#include "read/context/attributes.h"

/*
 * Warns of events whose condition has one outcome or whose expression keeps its sign. Also warns if the expression
 * depends only on time and does not cross zero in the event's direction.
 */
void warn_of_events(const struct Reader *reader);
