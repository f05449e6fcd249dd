/*
 * Value references of FMI 3.0, of scalars and arrays. They are 1 + the index among the variables, in FMI 2.0 the index:
 * OMSimulator takes the dependencies of FMI 3.0 for indices, which begin with 1, and stops at 0.
 */
#pragma once

#include "fmi3/fmi3_component.h"

/* An array of a caller, and its number of values. */
struct ValueArray {
  const void *array;
  size_t count;
};

/* Returns the index of the variable with an existing reference. */
static inline unsigned slot_of_reference(fmi3ValueReference reference) {
  return reference - 1;
}

/*
 * Expands the caller's references to indices of scalars: arrays become their elements. The result is in workspace. NULL
 * after logging an error, if arguments are wrong or the number of values differs.
 */
const unsigned *expand_references(struct FmiComponent *component, enum WorkspaceUse use, const fmi3ValueReference vr[],
                                  size_t nvr, struct ValueArray values);

/* Returns workspace for count elements; NULL after logging an error, without memory. */
void *reserve_workspace(struct FmiComponent *component, enum WorkspaceUse use, size_t count, size_t size);
