/* Parses the named expressions of definitions.h in topological order. */
#pragma once

#include "read/context/attributes.h"

/*
 * Parses all named expressions and defines their names, except outputs that none of them uses. Reports cycles. Sets
 * `parse` of the definitions, which later parses an output that another element uses.
 */
void resolve_definitions(struct Reader *reader);
