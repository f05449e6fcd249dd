/* <bushing>: springs and dampers along, and about, the axes of the frame that `from` names or is in. */
#pragma once

#include "read/context/attributes.h"

/* Adds its energy to the potential, and its damping to the dissipation. */
void read_bushing(struct Reader *reader, xmlNodePtr node);
