/* Parses the named expressions of definitions.h in topological order. */
#pragma once

#include "read/context/attributes.h"

/* Parses all named expressions and defines their names. Reports cycles. */
void resolve_definitions(struct Reader *reader);
