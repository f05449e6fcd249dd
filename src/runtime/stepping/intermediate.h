/* Values of a communication step on its way. */
#ifndef INTERMEDIATE_H
#define INTERMEDIATE_H

#include "instance/instance.h"

struct Intermediate {
  /*
   * Called at a time that the solver has come to. The instance has the values of that time, to be read alone, in the
   * PHASE_INTERMEDIATE_UPDATE; they leave no trace. Returns when the step shall end in place of end.
   */
  double (*update)(void *receiver, double time, double end);
  void *receiver;
  void *kept; /* workspace of situation_size() bytes */
};

/* For instance->observe. An error in the update ends the step, and leaves the instance in PHASE_ERROR. */
void intermediate_observe(struct Instance *instance, struct CommunicationStep *step, double time);

#endif
