#include "mechanics/motion.h"

#include "mechanics/lagrange.h"
#include "mechanics/linearize.h"
#include "mechanics/massless.h"

struct Equations *motion_of(struct Model *model, struct Diagnostics *diagnostics) {
  hold_massless_coordinates(model);
  struct Equations *equations = equations_derive(model, diagnostics);
  if (equations != NULL && model->linearized) {
    struct Equations *linear = linearize(model, equations, diagnostics);
    equations = linear;
  }
  if (equations != NULL) equations_check_finite(model, equations, diagnostics);
  return equations;
}
