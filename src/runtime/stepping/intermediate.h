/* Values within a communication step: intermediate update of FMI 3.0. */
#pragma once

#include "instance/instance.h"

/* Nodes of a communication step at which inputs are requested; they determine a polynomial of degree INPUT_ORDER. */
enum { INPUT_NODES = INPUT_ORDER + 1 };

/* The importer's callbacks within a step, with their workspace. */
struct Intermediate {
  /*
   * Called at the end of a solver step, at this time. The instance holds the values of that time, only for reading, in
   * PHASE_INTERMEDIATE_UPDATE. They are dropped afterwards. Returns the requested end of the step; end if it stays.
   */
  double (*update)(void *receiver, double time, double end);
  /*
   * Called at each node of a communication step, in ascending order, before the step begins. Inputs can be set then,
   * and nothing read, in PHASE_INPUT_REQUEST. An input that is not set keeps its last value.
   */
  void (*request)(void *receiver, double time);
  void *receiver;
  void *kept;     /* workspace of fmu_state_size() bytes */
  double *inputs; /* workspace of INPUT_NODES input_count numbers */
};

/* Implements instance->observe. An error in the update ends the step, and leaves the instance in PHASE_ERROR. */
void intermediate_observe(struct Instance *instance, struct CommunicationStep *step, double time);

/*
 * Implements instance->request_inputs. Replaces each input by the cubic through its values at the nodes. An error in a
 * request leaves the instance in PHASE_ERROR.
 */
void intermediate_request_inputs(struct Instance *instance, const struct CommunicationStep *step);
