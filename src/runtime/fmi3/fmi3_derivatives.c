/* Partial derivatives, time derivatives of outputs, and dependencies (sections 2.2.9, 2.2.11 and 4.2.1). */
#include "fmi/check.h"
#include "fmi/derivatives.h"
#include "fmi/life_cycle.h"
#include "fmi3/fmi3_component.h"
#include "fmi3/fmi3_references.h"

/* The scalars of a partial derivative. */
struct Partial {
  const unsigned *unknowns, *knowns; /* NULL after logging wrong arguments */
};

static struct Partial enter_with_partial(fmi3Instance c, const char *name, const fmi3ValueReference unknowns[],
                                         size_t nUnknowns, struct ValueArray of_unknowns,
                                         const fmi3ValueReference knowns[], size_t nKnowns,
                                         struct ValueArray of_knowns) {
  struct Partial partial = {NULL, NULL};
  if (enter(c, FUNCTION_GET_PARTIAL_DERIVATIVE, name) == NULL) return partial;
  partial.unknowns = expand_references(c, WORKSPACE_REFERENCES, unknowns, nUnknowns, of_unknowns);
  if (partial.unknowns != NULL) partial.knowns = expand_references(c, WORKSPACE_KNOWNS, knowns, nKnowns, of_knowns);
  return partial;
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, const fmi3ValueReference unknowns[], size_t nUnknowns,
                                        const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[],
                                        size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity) {
  struct Partial partial =
      enter_with_partial(c, __func__, unknowns, nUnknowns, (struct ValueArray){sensitivity, nSensitivity}, knowns,
                         nKnowns, (struct ValueArray){seed, nSeed});
  if (partial.knowns == NULL) return fmi3Error;
  return status_of(directional_derivative(c, partial.unknowns, nSensitivity, partial.knowns, nSeed, seed, sensitivity));
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance c, const fmi3ValueReference unknowns[], size_t nUnknowns,
                                    const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[],
                                    size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity) {
  struct Partial partial = enter_with_partial(c, __func__, unknowns, nUnknowns, (struct ValueArray){seed, nSeed},
                                              knowns, nKnowns, (struct ValueArray){sensitivity, nSensitivity});
  if (partial.knowns == NULL) return fmi3Error;
  return status_of(adjoint_derivative(c, partial.unknowns, nSeed, partial.knowns, nSensitivity, seed, sensitivity));
}

/* Each variable has one order, an array has several values. */
fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, const fmi3Int32 orders[],
                                    fmi3Float64 values[], size_t nValues) {
  struct Instance *instance = enter(c, FUNCTION_GET_OUTPUT_DERIVATIVES, __func__);
  if (instance == NULL || !check_array(instance, orders, nvr, "orders")) return fmi3Error;
  const unsigned *references =
      expand_references(c, WORKSPACE_REFERENCES, vr, nvr, (struct ValueArray){values, nValues});
  int *order_of = reserve_workspace(c, WORKSPACE_VALUES, nValues, sizeof *order_of);
  if (references == NULL || order_of == NULL) return fmi3Error;
  /* The next variable begins at its index. */
  for (size_t k = 0, i = 0; k < nValues; k++) {
    if (i < nvr && references[k] == slot_of_reference(vr[i])) i++;
    order_of[k] = orders[i - 1];
  }
  return status_of(output_derivatives(instance, references, nValues, order_of, values));
}

/* Dependencies in modelDescription.xml are those of whole variables: providesPerElementDependencies is false. */
static fmi3Status no_dependencies(fmi3Instance c, const char *name) {
  struct Instance *instance = enter(c, FUNCTION_GET_DEPENDENCIES, name);
  if (instance == NULL) return fmi3Error;
  return status_of(reject_call(instance, "providesPerElementDependencies is false; expected no call"));
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference valueReference,
                                               size_t *nDependencies) {
  (void)valueReference;
  (void)nDependencies;
  return no_dependencies(c, __func__);
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference dependent, size_t elementIndicesOfDependent[],
                                       fmi3ValueReference independents[], size_t elementIndicesOfIndependents[],
                                       fmi3DependencyKind dependencyKinds[], size_t nDependencies) {
  (void)dependent;
  (void)elementIndicesOfDependent;
  (void)independents;
  (void)elementIndicesOfIndependents;
  (void)dependencyKinds;
  (void)nDependencies;
  return no_dependencies(c, __func__);
}
