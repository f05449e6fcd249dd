/* How a communication step goes through events: the solver starts anew behind each of them. */
#ifndef PASSING_H
#define PASSING_H

#include "instance/event_laws.h"

/* The functions of the same names in struct EventLaws. */
bool switching_start(struct Instance *instance);
bool switching_part_contacts(struct Instance *instance, double time);
bool switching_settle_change(struct Instance *instance, double time);
const char *switching_check(struct Instance *instance, double time);
void switching_explain(struct Instance *instance, const struct CommunicationStep *step,
                       const struct EventProgress *progress);
const char *switching_update(struct Instance *instance, bool *changed);
const char *switching_pass(struct Instance *instance, struct CommunicationStep *step, struct EventProgress *progress);
const char *switching_pass_barrier(struct Instance *instance, struct CommunicationStep *step, const char *problem,
                                   struct EventProgress *progress);

#endif
