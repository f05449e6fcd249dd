/*
 * What is told after an input or a parameter was set between communication steps: the next step begins with new modes, and
 * where they change a state, with that. They are found on a copy, so that reading leaves no trace in the step.
 */
#ifndef FORESIGHT_H
#define FORESIGHT_H

#include "instance/instance.h"

/*
 * Between these two the situation is the one that the next step begins with, where anything was set that it settles; it is
 * the present one where there is none, as where the step will be discarded. Nothing may be set in between.
 */
void foresight_begin(struct Instance *instance);
void foresight_end(struct Instance *instance);

#endif
