/* Saves, restores and serializes the state of an instance. The caller points to a block of instance/snapshot.h. */
#pragma once

#include "instance/instance.h"

/* Saves the state in the memory of *state, or, if that is NULL, in memory that it allocates. */
enum Status saved_state_get(struct Instance *instance, void **state);

/* Restores the state; an error if the block is damaged or of another FMU. */
enum Status saved_state_set(struct Instance *instance, const void *state);

/* Frees *state, and sets it to NULL. */
enum Status saved_state_free(struct Instance *instance, void **state);

/* Returns the bytes of a state. */
enum Status saved_state_size(struct Instance *instance, const void *state, size_t *size);

/* Writes a state to bytes[size]. Returns an error if size is too small. */
enum Status saved_state_write(struct Instance *instance, const void *state, void *bytes, size_t size);

/* Reads a state from bytes[size] into memory as saved_state_get() does; an error if they are damaged. */
enum Status saved_state_read(struct Instance *instance, const void *bytes, size_t size, void **state);
