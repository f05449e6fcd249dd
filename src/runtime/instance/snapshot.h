/* Serialized states of an instance (snapshot.c). */
#pragma once

#include "instance/instance.h"

/* Returns the bytes of a block. */
size_t snapshot_size(void);

/* Writes the instance's state into a block of snapshot_size() bytes. */
void snapshot_take(const struct Instance *instance, void *block);

/* Returns the fault of bytes that are not a saved state of this instance; NULL if they are valid. */
const char *snapshot_fault(const struct Instance *instance, const void *block, size_t size);

/* True if count doubles at any alignment are finite; for solvers that check their parts. */
bool snapshot_is_finite(const void *numbers, size_t count);

/* True if all counters are in their range. */
bool snapshot_are_counts(const int64_t *counts, size_t count);

/* Restores a block for which snapshot_fault() returned NULL. */
void snapshot_restore(struct Instance *instance, const void *block);
