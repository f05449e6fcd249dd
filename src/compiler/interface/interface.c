#include "interface/interface.h"

#include <math.h>

size_t interface_find(const struct Interface *interface, enum VariableKind kind, size_t index) {
  return interface->first[kind] + index;
}

long interface_max_steps(const struct Model *model) {
  return isnan(model->solver.max_steps) ? 0 : (long)model->solver.max_steps;
}

double interface_tolerance(const struct Model *model) {
  return isnan(model->solver.tolerance) ? 1e-8 : model->solver.tolerance;
}
