/* Communication steps. */
#ifndef STEPS_H
#define STEPS_H

#include "instance/instance.h"

/*
 * Goes on from time by size. Discards after
 * logging where the solver came to a part of the step alone, which situation->time then tells.
 */
enum Status communication_step(struct Instance *instance, double time, double size);

#endif
