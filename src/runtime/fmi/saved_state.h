/*
 * Saving, restoring and serializing the state of an instance, for a caller who holds it by a pointer: it points to a
 * snapshot.
 */
#ifndef SAVED_STATE_H
#define SAVED_STATE_H

#include "instance/instance.h"

/* Into the memory of *state, or where that is NULL, into memory of its own. */
enum Status saved_state_get(struct Instance *instance, void **state);

enum Status saved_state_set(struct Instance *instance, const void *state);

/* Frees *state, and makes it NULL. */
enum Status saved_state_free(struct Instance *instance, void **state);

/* The bytes of a state. */
enum Status saved_state_size(struct Instance *instance, const void *state, size_t *size);

enum Status saved_state_write(struct Instance *instance, const void *state, void *bytes, size_t size);

enum Status saved_state_read(struct Instance *instance, const void *bytes, size_t size, void **state);

#endif
