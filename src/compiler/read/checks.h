/* What no single element of a system shows. */
#pragma once

#include "read/context/attributes.h"

/* Reports a system without content, work without forces, ... and warns of what is likely a mistake. */
void check_system(struct Reader *reader);
