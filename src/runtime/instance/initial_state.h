/*
 * States whose start values are expressions of parameters: before the simulation they follow these at once, unless they
 * were set themselves.
 */
#ifndef INITIAL_STATE_H
#define INITIAL_STATE_H

#include "instance/instance.h"

/* Whether the simulation has not begun. */
static inline bool is_before_start(const struct Instance *instance) {
  return instance->situation->phase == PHASE_INSTANTIATED || instance->situation->phase == PHASE_INITIALIZATION;
}

/* The state was set, and keeps its value until the next reset. */
void initial_state_set(struct Instance *instance, size_t state);

/* Brings those that were not set up to date with the parameters. */
void initial_state_follow(struct Instance *instance);

/* Adds to state[state_count] what those that were not set change by along parameters; scratch[state_count]. */
void initial_state_add_along(struct Instance *instance, const double *parameter, double *state, double *scratch);

/* An error that names a state without a finite start value. */
enum Status initial_state_check(struct Instance *instance);

#endif
