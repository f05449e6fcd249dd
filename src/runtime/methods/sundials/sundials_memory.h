/*
 * Memory of SUNDIALS. The library takes no allocator, and does not survive an allocation that fails. The linker sends
 * its calls of malloc and the like to this file (--wrap), which uses the importer's functions. If memory is missing,
 * longjmp leaves the library, and all that it has allocated is freed.
 */
#pragma once

#include "instance/instance.h"

/* Header of each block that SUNDIALS or its solver has allocated. */
struct SundialsBlock;

/* First member of the memory of each solver. */
struct SundialsMemory {
  struct SundialsBlock *blocks;
};

/*
 * Runs a task that may call SUNDIALS, and may create or destroy solver_memory. Nothing else may call the library. False
 * if memory was missing: the task was left halfway, and solver_memory has been freed and is NULL.
 */
bool sundials_run(struct Instance *instance, void (*task)(void *argument), void *argument);

/* Allocates zeros, inside a task only. Does not return if memory is missing. */
void *sundials_allocate(size_t count, size_t size);

/* Frees solver_memory and all that was allocated for it. */
void sundials_destroy(struct Instance *instance);
