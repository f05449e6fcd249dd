/*
 * What an importer that integrates asks for. The only events are those in which a state that drifted from the constraints
 * is brought back. Messages come under the name of the function that the caller called.
 */
#ifndef MODEL_EXCHANGE_H
#define MODEL_EXCHANGE_H

#include "instance.h"

enum Status exchange_set_time(struct Instance *instance, double time, const char *function);

/* Arrays have state_count elements; another count is an error. */
enum Status exchange_set_states(struct Instance *instance, const double *state, size_t count, const char *function);
enum Status exchange_get_states(struct Instance *instance, double *state, size_t count, const char *function);
enum Status exchange_get_derivatives(struct Instance *instance, double *derivative, size_t count, const char *function);
enum Status exchange_get_nominals(struct Instance *instance, double *nominal, size_t count, const char *function);

/* How many event indicators the system has. */
size_t exchange_event_indicator_count(void);

/* The array has as many elements; another count is an error. */
enum Status exchange_get_event_indicators(struct Instance *instance, double *indicator, size_t count,
                                          const char *function);

/* Whether the state has drifted from the constraints by more than the tolerance, so that an event is needed. */
bool exchange_needs_event(struct Instance *instance);

/* Brings the state back to the constraints, and tells whether it was moved. */
enum Status exchange_update(struct Instance *instance, bool *states_changed);

#endif
