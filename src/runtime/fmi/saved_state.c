#include "fmi/saved_state.h"

#include <string.h>

#include "fmi/check.h"
#include "instance/snapshot.h"

/* Allocates memory for the caller's state if it has none. */
static bool allocate(struct Instance *instance, void **state) {
  if (*state == NULL) *state = instance->memory.allocate(1, snapshot_size());
  if (*state == NULL) reject_call(instance, "allocateMemory returned no memory");
  return *state != NULL;
}

/* True if the bytes can be restored; logs an error otherwise. */
static bool check_state(struct Instance *instance, const void *block, size_t size) {
  const char *fault = snapshot_fault(instance, block, size);
  if (fault != NULL) reject_call(instance, "the bytes of the state cannot be used: %s", fault);
  return fault == NULL;
}

enum Status saved_state_get(struct Instance *instance, void **state) {
  if (!check_array(instance, state, 1, "FMUstate") || !allocate(instance, state)) return STATUS_ERROR;
  snapshot_take(instance, *state);
  return STATUS_DONE;
}

enum Status saved_state_set(struct Instance *instance, const void *state) {
  if (!check_array(instance, state, 1, "FMUstate") || !check_state(instance, state, snapshot_size()))
    return STATUS_ERROR;
  snapshot_restore(instance, state);
  return STATUS_DONE;
}

enum Status saved_state_free(struct Instance *instance, void **state) {
  if (state == NULL || *state == NULL) return STATUS_DONE;
  instance->memory.free(*state);
  *state = NULL;
  return STATUS_DONE;
}

enum Status saved_state_size(struct Instance *instance, const void *state, size_t *size) {
  if (!check_array(instance, state, 1, "FMUstate") || !check_array(instance, size, 1, "size")) return STATUS_ERROR;
  *size = snapshot_size();
  return STATUS_DONE;
}

enum Status saved_state_write(struct Instance *instance, const void *state, void *bytes, size_t size) {
  if (!check_array(instance, state, 1, "FMUstate") || !check_array(instance, bytes, 1, "serializedState"))
    return STATUS_ERROR;
  if (size < snapshot_size()) return reject_call(instance, "the size is %zu; expected %zu", size, snapshot_size());
  memcpy(bytes, state, snapshot_size());
  return STATUS_DONE;
}

enum Status saved_state_read(struct Instance *instance, const void *bytes, size_t size, void **state) {
  if (!check_array(instance, bytes, size, "serializedState") || !check_array(instance, state, 1, "FMUstate") ||
      !check_state(instance, bytes, size) || !allocate(instance, state))
    return STATUS_ERROR;
  memcpy(*state, bytes, snapshot_size());
  return STATUS_DONE;
}
