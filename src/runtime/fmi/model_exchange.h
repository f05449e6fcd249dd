/*
 * Functions for importers that integrate; events also in co-simulation of FMI 3.0. At an event modes may change, and a
 * state that has drifted is projected onto the constraints.
 */
#pragma once

#include "instance/instance.h"

enum Status exchange_set_time(struct Instance *instance, double time);

/* Set or get arrays of state_count elements; another count is an error. */
enum Status exchange_set_states(struct Instance *instance, const double *state, size_t count);
enum Status exchange_get_states(struct Instance *instance, double *state, size_t count);
enum Status exchange_get_derivatives(struct Instance *instance, double *derivative, size_t count);
enum Status exchange_get_nominals(struct Instance *instance, double *nominal, size_t count);

/* Gets an array with an element for each event indicator; another count is an error. */
enum Status exchange_get_event_indicators(struct Instance *instance, double *indicator, size_t count);

/* Enters event mode, in which modes and discrete variables may change; an error past stopTime. */
enum Status exchange_enter_event_mode(struct Instance *instance);

/* True if modes do not agree with the present state and time. */
bool exchange_is_event_due(struct Instance *instance);

/*
 * Enters continuous-time mode, or step mode in co-simulation. An error if the discrete states were not updated
 * since event mode began, or since a value was set by which an event is due. The event iteration has then not
 * converged (FMI
 * 2.0.4, section 3.2.2; FMI 3.0.2, section 2.3.5).
 */
enum Status exchange_leave_event_mode(struct Instance *instance);

/*
 * Counts a step of the importer; an error past stopTime. *needs_event: a mode must change, or the drift is as large as
 * the error of the motion (model_exchange.c).
 */
enum Status exchange_complete_step(struct Instance *instance, bool *needs_event);

/*
 * Brings the modes into agreement with the state, and projects it. Sets *states_changed if a continuous state changed
 * in any bit, as valuesOfContinuousStatesChanged reports (FMI 2.0.4, section 3.2.2).
 */
enum Status exchange_update(struct Instance *instance, bool *states_changed);

/* Finds the next time event, after an update. False if there is none. */
bool exchange_next_event(struct Instance *instance, double *time);
