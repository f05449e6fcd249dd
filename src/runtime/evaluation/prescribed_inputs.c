#include "evaluation/prescribed_inputs.h"

/* Returns the derivative of an input's polynomial; order 0 is its value. */
static double *derivative_of(struct Instance *instance, size_t input, size_t order) {
  return order == 0 ? &instance->input[input]
                    : &instance->input_derivatives[(order - 1) * lagrangian.input_count + input];
}

static bool has_polynomial(struct Instance *instance, size_t input) {
  bool has = false;
  for (size_t order = 1; order <= INPUT_ORDER; order++) has |= *derivative_of(instance, input, order) != 0.0;
  return has;
}

void prescribed_inputs_begin_step(struct Instance *instance) {
  for (size_t i = 0; i < lagrangian.constraints.prescribed_input_count; i++) {
    const struct PrescribedInput *prescribed_input = &lagrangian.constraints.prescribed_inputs[i];
    bool is_set = has_polynomial(instance, prescribed_input->input);
    for (size_t order = 1; order <= INPUT_ORDER && !is_set; order++) {
      size_t rate = order < prescribed_input->rates ? order : prescribed_input->rates;
      *derivative_of(instance, prescribed_input->input, order) =
          *derivative_of(instance, prescribed_input->input + rate, order - rate);
    }
    for (size_t rate = 1; rate <= prescribed_input->rates; rate++)
      for (size_t order = 0; order <= INPUT_ORDER; order++)
        *derivative_of(instance, prescribed_input->input + rate, order) =
            order + rate <= INPUT_ORDER ? *derivative_of(instance, prescribed_input->input, order + rate) : 0.0;
    instance->fmu_state->input_derivatives_set = 1;
  }
}
