/* Start and end of a simulation. */
#pragma once

#include "instance/instance.h"

/* The experiment as the importer defines it; values are valid if the flags say so. */
struct ExperimentSetup {
  double start_time, stop_time; /* in s */
  double tolerance;             /* relative */
  bool has_stop_time, has_tolerance;
};

/* Stores the experiment and checks it. */
enum Status simulation_set_up(struct Instance *instance, const struct ExperimentSetup *experiment);

/* Ends initialization mode; an error if there is no start with accelerations. */
enum Status simulation_start(struct Instance *instance);

/* Ends the simulation; the instance can be read or reset afterwards. */
void simulation_terminate(struct Instance *instance);
