/* Communication steps (FMI: DoStep). */
#pragma once

#include "instance/instance.h"

/*
 * Advances from time by size, both in s. Returns STATUS_DISCARD, after logging, if only a part of the step could be
 * made; fmu_state->time is then its end.
 */
enum Status communication_step(struct Instance *instance, double time, double size);
