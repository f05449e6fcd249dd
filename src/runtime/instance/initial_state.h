/* States whose start values are expressions of parameters. Until the start they follow these, unless set themselves. */
#ifndef INITIAL_STATE_H
#define INITIAL_STATE_H

#include "instance/instance.h"

/* True if the simulation has not started. */
static inline bool is_before_start(const struct Instance *instance) {
  return instance->fmu_state->phase == PHASE_INSTANTIATED || instance->fmu_state->phase == PHASE_INITIALIZATION;
}

/* Marks the state as set: it keeps its value until the next reset. */
void initial_state_set(struct Instance *instance, size_t state);

/* Updates the states that follow from the parameters. */
void initial_state_follow(struct Instance *instance);

/* Adds to state[state_count] the directional derivative of states that follow from parameters. scratch: state_count. */
void initial_state_add_along(struct Instance *instance, const double *parameter, double *state, double *scratch);

/* Checks that the start values are finite; an error names the state. */
enum Status initial_state_check(struct Instance *instance);

#endif
