/* The named expressions of definitions.h are read, each after those that it needs. */
#pragma once

#include "read/context/attributes.h"

/* Reads all of them and makes their names known; names those that need each other in a circle. */
void resolve_definitions(struct Reader *reader);
