/* The inputs that stand in constraints, as C. */
#pragma once

#include <stdio.h>

#include "model/model.h"

/* Whether some constraint holds an input. */
bool has_constraint_inputs(const struct Model *model);

/* guides[] and constraint_inputs[] of include/lagrangian.h. */
void constraint_inputs_write(FILE *file, const struct Model *model);
