/* Events that cannot happen. */
#pragma once

#include "read/context/attributes.h"

/* Warns of events whose expressions rest on time alone and never pass 0 in their direction from the start values on. */
void warn_of_events(const struct Reader *reader);
