/* Checks of a whole system, beyond single elements. */
#pragma once

#include "read/context/attributes.h"

/* Reports systems without content, work without forces and the like, and warns of probable mistakes. */
void check_system(struct Reader *reader);
