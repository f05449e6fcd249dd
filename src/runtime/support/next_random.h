/* Random numbers for starts and probes, where equal bits on all machines matter more than quality. */
#pragma once

#include <stdint.h>

/* Returns the next 24 random bits, by the generator of D. E. Knuth and H. W. Lewis. The seed is its state. */
static inline uint32_t next_random(uint32_t *seed) {
  *seed = *seed * 1664525u + 1013904223u;
  return *seed >> 8;
}
