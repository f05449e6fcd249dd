/* <bushing>: springs and dampers along and about the axes of the frame of `from`. */
#pragma once

#include "read/context/attributes.h"

/* Adds the energy of a bushing to the potential, and its damping to the dissipation. */
void read_bushing(struct Reader *reader, xmlNodePtr node);
