/*
 * Memory of SUNDIALS. The library does not bear an allocation that fails, and takes no allocator: the linker sends its
 * calls of malloc and the like here (--wrap). They get memory from the caller's functions, and where these have none,
 * the library is left at once, and all that it has allocated goes back.
 */
#ifndef SUNDIALS_MEMORY_H
#define SUNDIALS_MEMORY_H

#include "instance/instance.h"

/* Precedes each block that SUNDIALS or its solver has allocated and not freed. */
struct Block;

/* The memory of each solver begins with this. */
struct SundialsMemory {
  struct Block *blocks;
};

/*
 * Does a task that may enter SUNDIALS, create solver_memory or give it up: nothing else may call the library. False
 * where there was no memory: the task was left halfway, and solver_memory is freed, and NULL.
 */
bool sundials_run(struct Instance *instance, void (*task)(void *argument), void *argument);

/* Zeros; only inside of a task, which it does not come back to where there is no memory. */
void *sundials_allocate(size_t count, size_t size);

/* Frees solver_memory and all that was allocated for it. */
void sundials_destroy(struct Instance *instance);

#endif
