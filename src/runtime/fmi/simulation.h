/* A simulation's beginning and end; messages come under the name of the function that the caller called. */
#ifndef SIMULATION_H
#define SIMULATION_H

#include "instance/instance.h"

struct Experiment {
  double start_time, stop_time; /* s */
  double tolerance;             /* relative */
  bool has_stop_time, has_tolerance;
};

enum Status simulation_set_up(struct Instance *instance, const struct Experiment *experiment, const char *function);

/* Ends the initialization: an error where the accelerations do not exist. */
enum Status simulation_start(struct Instance *instance, const char *function);

void simulation_terminate(struct Instance *instance);

#endif
