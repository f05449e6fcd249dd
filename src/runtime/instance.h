/* One instance of the FMU: nothing here is shared between instances. */
#ifndef INSTANCE_H
#define INSTANCE_H

#include <stdbool.h>
#include <stdint.h>

#include "fmi2.h"
#include "lagrangian.h"
#include "life_cycle.h"

enum { INPUT_ORDER = 3 }; /* the highest input derivative; an input is a polynomial over a step */

/*
 * All that fmi2GetFMUstate saves, in one block of memory without pointers. The values are state, input, parameter,
 * the input derivatives of order 1, then 2, then 3, and what the solver keeps.
 */
struct Situation {
  int32_t mode; /* enum Mode */
  int32_t type; /* fmi2Type */
  int32_t experiment_defined, stop_time_defined;
  int32_t input_derivatives_set; /* for the step to come */
  int32_t changed;               /* state, inputs or parameters were, since the last step */
  int32_t statistics[STATISTIC_COUNT];
  double time, start_time, stop_time;
  double tolerance;
  double suggested_step; /* of a one-step solver, not clipped by the communication step; 0 for none */
  double values[];
};

struct Instance {
  fmi2CallbackLogger logger;
  fmi2CallbackAllocateMemory allocate;
  fmi2CallbackFreeMemory free;
  fmi2ComponentEnvironment environment;
  char *name;
  fmi2Type type;
  unsigned log_categories; /* bit: enum LogCategory */
  struct Situation *situation;
  double *state, *input, *parameter, *input_derivatives; /* inside situation->values */
  void *saved;                                           /* what the solver keeps inside situation->values */
  double *prepared;
  bool prepared_is_stale;
  bool solver_is_stale; /* the situation was replaced: what the solver keeps outside of it no longer counts */
  int singular;         /* 1 + the coordinate in which the mass matrix was found singular last, 0 for none */
  double *point_work;   /* lagrangian.work_count, for generated functions */
  double *work;         /* 3 state_count + 2 input_count + parameter_count, for evaluations */
  void *solver_memory;
};

/* Bytes of the situation of this system. */
size_t situation_size(void);

/* The situation after instantiation: start values, nothing defined. */
void situation_reset(struct Instance *instance);

#endif
