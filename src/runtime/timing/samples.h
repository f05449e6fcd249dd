/* Samples: events at times base + count period. */
#ifndef SAMPLES_H
#define SAMPLES_H

#include "instance/instance.h"

/* Sets the modes of the samples so that the next one is the first from the time of the situation on. */
void samples_start(struct Instance *instance);

#endif
