/* Samples: events at times base + count * period. */
#pragma once

#include "instance/instance.h"

/* Sets the modes of the samples, so that the next sample is the first one from the present time on. */
void samples_start(struct Instance *instance);
