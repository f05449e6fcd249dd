/*
 * Saving, restoring and serializing the state of an instance, for a caller who holds it by a pointer: it points to a
 * snapshot. Messages come under the name of the function that the caller called.
 */
#ifndef SAVED_STATE_H
#define SAVED_STATE_H

#include "instance/instance.h"

/* Into the memory of *state, or where that is NULL, into memory of its own. */
enum Status saved_state_get(struct Instance *instance, void **state, const char *function);

enum Status saved_state_set(struct Instance *instance, const void *state, const char *function);

/* Frees *state, and makes it NULL. */
enum Status saved_state_free(struct Instance *instance, void **state);

/* The bytes of a state. */
enum Status saved_state_size(struct Instance *instance, const void *state, size_t *size, const char *function);

enum Status saved_state_write(struct Instance *instance, const void *state, void *bytes, size_t size,
                              const char *function);

enum Status saved_state_read(struct Instance *instance, const void *bytes, size_t size, void **state,
                             const char *function);

#endif
