/* Start values of coordinates and velocities: numbers, or expressions of parameters, which they then follow. */
#pragma once

#include "read/context/attributes.h"

/* Those of a <coordinate>, in the order of the declarations. */
void read_start_expressions(struct Reader *reader, xmlNodePtr node);
void read_start_of_state(struct Reader *reader, xmlNodePtr node);

/* Their values at the start values of the parameters; reports those that are not finite. */
void evaluate_start_expressions(struct Reader *reader);
