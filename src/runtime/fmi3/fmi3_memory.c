#include "fmi3/fmi3_memory.h"

#include <stdlib.h>

/*
 * In a library with SUNDIALS, the linker sends calloc and free to sundials_memory.c, which calls the instance's
 * allocator: this one. So it must call the functions of the C library themselves.
 */
#ifdef MEMORY_IS_WRAPPED
void *__real_calloc(size_t count, size_t size);
void __real_free(void *block);
const struct Allocator fmi3_memory = {__real_calloc, __real_free};
#else
const struct Allocator fmi3_memory = {calloc, free};
#endif
