/* Value references of arrays. */
#ifndef FMI3_REFERENCES_H
#define FMI3_REFERENCES_H

#include "fmi3/fmi3_component.h"

/* An array of a caller, with the number of its values. */
struct Values {
  const void *array;
  size_t count;
};

/*
 * The value references of scalars for those of the caller: in place of an array stand those of its elements. The result is
 * the caller's array or the workspace. NULL after logging where arguments are wrong or the number of values is another.
 */
const unsigned *expand_references(struct Component *component, enum WorkspaceUse use, const fmi3ValueReference vr[],
                                  size_t nvr, struct Values values);

/* Room in a workspace for so many elements; NULL after logging where there is no memory. */
void *reserve_workspace(struct Component *component, enum WorkspaceUse use, size_t count, size_t size);

#endif
