#include "mechanics/motion.h"

#include "mechanics/lagrange.h"
#include "mechanics/linearize.h"
#include "mechanics/massless.h"
#include "mechanics/method_choice.h"
#include "mechanics/switching.h"

struct Equations *motion_of(struct Model *model, struct Diagnostics *diagnostics) {
  regularize_massless_coordinates(model);
  struct Equations *equations = equations_derive(model, diagnostics);
  if (equations != NULL && model->linearized) {
    struct Equations *linear = linearize(model, equations, diagnostics);
    equations = linear;
  }
  if (equations == NULL) return NULL;
  equations_check_finite(model, equations, diagnostics);
  equations->method = method_of(model, equations);
  equations->switching = switching_derive(model, equations);
  return equations;
}
