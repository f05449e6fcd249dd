/* Inputs in constraints: prescribed motion. */
#pragma once

#include "instance/instance.h"

/* True if the input occurs in a constraint, or is a time derivative of one that does. */
static inline bool is_prescribed_input(size_t input) {
  const struct ConstraintTable *constraints = &lagrangian.constraints;
  bool prescribes = false;
  for (size_t i = 0; i < constraints->prescribed_input_count; i++)
    prescribes |= input >= constraints->prescribed_inputs[i].input &&
                  input <= constraints->prescribed_inputs[i].input + constraints->prescribed_inputs[i].rates;
  return prescribes;
}

/*
 * Prepares the inputs of constraints for the next step. A constraint also holds for velocities and accelerations. So
 * each of these inputs and its time derivatives, which are inputs too, become one polynomial and its derivatives. It is
 * the polynomial that was set for the input, or else follows from the derivatives.
 */
void prescribed_inputs_begin_step(struct Instance *instance);
