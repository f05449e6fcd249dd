/*
 * Value references of FMI 3.0, of scalars and arrays. They begin with 1, where those of FMI 2.0 are places among the
 * variables: OMSimulator takes the dependencies of FMI 3.0 for indices, which begin with 1, and stops at 0.
 */
#ifndef FMI3_REFERENCES_H
#define FMI3_REFERENCES_H

#include "fmi3/fmi3_component.h"

/* An array of a caller, with the number of its values. */
struct Values {
  const void *array;
  size_t count;
};

/* The place of the variable, of a reference that there is. */
static inline unsigned place_of_reference(fmi3ValueReference reference) {
  return reference - 1;
}

/*
 * The places of scalars for the caller's references: in place of an array stand its elements. The result is the workspace.
 * NULL after logging where arguments are wrong or the number of values is another.
 */
const unsigned *expand_references(struct Component *component, enum WorkspaceUse use, const fmi3ValueReference vr[],
                                  size_t nvr, struct Values values);

/* Room in a workspace for so many elements; NULL after logging where there is no memory. */
void *reserve_workspace(struct Component *component, enum WorkspaceUse use, size_t count, size_t size);

#endif
