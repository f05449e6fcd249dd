/* Arrays in one block. A function that takes them one by one lays out the block; from address 0 on, it counts bytes. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "real.h"

/* The address of the next array. */
struct Arena {
  uintptr_t next;
};

/* Returns the next count elements of size bytes. */
static inline void *arena_take(struct Arena *arena, size_t count, size_t size) {
  void *array = (void *)arena->next; /* NOLINT(performance-no-int-to-ptr) */
  arena->next += count * size;
  return array;
}

/* Takes the next count elements for an array. */
#define ARENA_TAKE(arena, array, count) ((array) = arena_take(arena, count, sizeof *(array)))

/* Takes count numbers for each of the arrays at these addresses. */
#define ARENA_NUMBERS(arena, count, ...)                                                                               \
  arena_take_numbers(arena, count, (Real * *[]){__VA_ARGS__}, sizeof((Real **[]){__VA_ARGS__}) / sizeof(Real **))

static inline void arena_take_numbers(struct Arena *arena, size_t count, Real **const *arrays, size_t array_count) {
  for (size_t i = 0; i < array_count; i++) *arrays[i] = arena_take(arena, count, sizeof(Real));
}
