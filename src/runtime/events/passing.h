/* Communication steps through events: the solver restarts after each of them. */
#pragma once

#include "instance/event_laws.h"

/* Implement the functions of these names in struct EventLaws. */
bool events_start(struct Instance *instance);
bool events_part(struct Instance *instance, double time);
bool events_resolve_change(struct Instance *instance, double time);
const char *events_check(struct Instance *instance, double time);
void events_explain(struct Instance *instance, const struct CommunicationStep *step,
                    const struct EventProgress *progress);
bool events_explain_stop(struct Instance *instance, double time);
const char *events_update(struct Instance *instance);
const char *events_pass(struct Instance *instance, struct CommunicationStep *step, struct EventProgress *progress);
const char *events_pass_barrier(struct Instance *instance, struct CommunicationStep *step, const char *problem,
                                struct EventProgress *progress);
bool events_step_over(struct Instance *instance, const struct CommunicationStep *step, struct EventProgress *progress);
