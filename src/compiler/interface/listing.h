/* Lists the variables of an FMU. */
#pragma once

#include "interface/interface.h"

/* Returns all variables, without arrays; see arrays.h. */
struct Interface *interface_create(const struct Model *model, const struct Equations *equations);
