#include "fmi3/fmi3_references.h"

#include "fmi/check.h"
#include "fmi3/fmi3_memory.h"

/* Returns the array that contains the variable of this index; NULL for a scalar. */
static const struct ArrayVariable *array_with(unsigned slot) {
  for (size_t i = 0; i < lagrangian.array_count; i++)
    if (slot - lagrangian.arrays[i].first < lagrangian.arrays[i].count) return &lagrangian.arrays[i];
  return NULL;
}

/* Counts the values of the variables. False, after logging an error, for unknown references and elements of arrays. */
static bool count_values(struct Instance *instance, const fmi3ValueReference vr[], size_t nvr, size_t *count) {
  *count = 0;
  for (size_t i = 0; i < nvr; i++) {
    if (vr[i] == 0 || vr[i] > lagrangian.variable_count) {
      reject_call(instance, "the value reference %u is unknown; expected one from 1 to %zu", vr[i],
                  lagrangian.variable_count);
      return false;
    }
    unsigned slot = slot_of_reference(vr[i]);
    const struct ArrayVariable *array = array_with(slot);
    *count += array != NULL ? array->count : 1;
    if (array == NULL || array->first == slot) continue;
    reject_call(instance, "the value reference %u is of '%s', an element of an array; expected %zu, of the array",
                vr[i], lagrangian.variables[slot].name, array->first + 1);
    return false;
  }
  return true;
}

void *reserve_workspace(struct FmiComponent *component, enum WorkspaceUse use, size_t count, size_t size) {
  struct Workspace *workspace = &component->workspaces[use];
  if (workspace->block != NULL && count <= workspace->size / size) return workspace->block;
  fmi3_memory.free(workspace->block);
  workspace->block = fmi3_memory.allocate(count + 1, size);
  workspace->size = workspace->block != NULL ? count * size : 0;
  if (workspace->block == NULL) reject_call(&component->instance, "out of memory for %zu values", count);
  return workspace->block;
}

const unsigned *expand_references(struct FmiComponent *component, enum WorkspaceUse use, const fmi3ValueReference vr[],
                                  size_t nvr, struct ValueArray values) {
  struct Instance *instance = &component->instance;
  size_t count;
  if (!check_array(instance, vr, nvr, "valueReferences") ||
      !check_array(instance, values.array, values.count, "values") || !count_values(instance, vr, nvr, &count))
    return NULL;
  if (count != values.count) {
    reject_call(instance, "there are %zu values; expected %zu, as many as the variables have", values.count, count);
    return NULL;
  }
  unsigned *references = reserve_workspace(component, use, count, sizeof *references);
  for (size_t i = 0, k = 0; i < nvr && references != NULL; i++) {
    unsigned slot = slot_of_reference(vr[i]);
    const struct ArrayVariable *array = array_with(slot);
    for (unsigned j = 0; j < (array != NULL ? array->count : 1); j++) references[k++] = slot + j;
  }
  return references;
}
