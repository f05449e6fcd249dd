/* Lists the variables of an FMU. */
#pragma once

#include "interface/interface.h"

/* All of them, without arrays: see arrays.h. */
struct Interface *interface_create(const struct Model *model, const struct Equations *equations);
