/* Checks for events that cannot happen. */
#pragma once

#include "read/context/attributes.h"

/* Warns of events whose expression depends only on time and never crosses zero in the event's direction. */
void warn_of_events(const struct Reader *reader);
