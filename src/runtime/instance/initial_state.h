/*
 * States and modes whose start values are expressions of parameters. Until the start they follow the
 * parameters, unless they were set themselves.
 */
#pragma once

#include "instance/instance.h"

/* True if the simulation has not started. */
static inline bool is_before_start(const struct Instance *instance) {
  return instance->fmu_state->phase == PHASE_INSTANTIATED || instance->fmu_state->phase == PHASE_INITIALIZATION;
}

/* Marks a variable as set: it keeps its value until the next reset. */
void initial_state_set(struct Instance *instance, const struct ScalarVariable *variable);

/* Updates the states and modes that follow from the parameters. */
void initial_state_follow(struct Instance *instance);

/* Adds to state[] and parameter[] the directional derivatives of states and modes that follow from parameters. */
void initial_state_add_along(struct Instance *instance, double *state, double *parameter);

/* Checks that the start values are finite; an error names the state. */
enum Status initial_state_check(struct Instance *instance);
