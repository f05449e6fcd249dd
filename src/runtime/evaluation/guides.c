#include "evaluation/guides.h"

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

void guides_begin_step(struct Instance *instance) {
  for (size_t i = 0; i < lagrangian.constraints.guide_count; i++) {
    const struct Guide *guide = &lagrangian.constraints.guides[i];
    bool is_set = has_polynomial(instance, guide->input);
    for (size_t order = 1; order <= INPUT_ORDER && !is_set; order++) {
      size_t rate = order < guide->rates ? order : guide->rates;
      *derivative_of(instance, guide->input, order) = *derivative_of(instance, guide->input + rate, order - rate);
    }
    for (size_t rate = 1; rate <= guide->rates; rate++)
      for (size_t order = 0; order <= INPUT_ORDER; order++)
        *derivative_of(instance, guide->input + rate, order) =
            order + rate <= INPUT_ORDER ? *derivative_of(instance, guide->input, order + rate) : 0.0;
    instance->situation->input_derivatives_set = 1;
  }
}
