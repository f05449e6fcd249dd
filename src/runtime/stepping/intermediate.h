/* Values within a communication step: intermediate update of FMI 3.0. */
#ifndef INTERMEDIATE_H
#define INTERMEDIATE_H

#include "instance/instance.h"

struct Intermediate {
  /*
   * Called at the end of a solver step, at this time. The instance holds the values of that time, for reading alone, in
   * PHASE_INTERMEDIATE_UPDATE. They are dropped afterwards. Returns the requested end of the step; end if it stays.
   */
  double (*update)(void *receiver, double time, double end);
  void *receiver;
  void *kept; /* workspace of situation_size() bytes */
};

/* Implements instance->observe. An error in the update ends the step, and leaves the instance in PHASE_ERROR. */
void intermediate_observe(struct Instance *instance, struct CommunicationStep *step, double time);

#endif
