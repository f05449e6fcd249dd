/* Saved states of an instance: blocks of bytes without pointers, which another process may restore. */
#ifndef SNAPSHOT_H
#define SNAPSHOT_H

#include "instance/instance.h"

/* Bytes of a block. */
size_t snapshot_size(void);

void snapshot_take(const struct Instance *instance, void *block);

/* What is wrong with bytes that claim to be a saved state for this instance; NULL where nothing is. */
const char *snapshot_fault(const struct Instance *instance, const void *block, size_t size);

/* Whether bytes, at any address, are so many finite numbers; for solvers that check what they kept. */
bool snapshot_is_finite(const void *numbers, size_t count);

/* Whether all are counts that can go on counting; likewise. */
bool snapshot_are_counts(const int64_t *counts, size_t count);

/* The block must have no fault. */
void snapshot_restore(struct Instance *instance, const void *block);

#endif
