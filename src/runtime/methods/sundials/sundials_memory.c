#include "methods/sundials/sundials_memory.h"

#include <setjmp.h>
#include <string.h>

/* A block in the ring of all blocks of a solver. */
struct SundialsBlock {
  struct SundialsBlock *previous, *next;
  size_t size; /* of content, in bytes */
  _Alignas(max_align_t) char content[];
};

/* A call of sundials_run() in progress. */
struct SundialsCall {
  const struct Allocator *memory;
  struct SundialsBlock *blocks;
  jmp_buf out_of_memory;
};

/*
 * The innermost task of this thread. It is in the thread's static block. Otherwise the first access in a thread
 * would allocate, and the C library would end the process if that failed.
 */
static _Thread_local struct SundialsCall *current __attribute__((tls_model("initial-exec")));

static void free_all(const struct Allocator *memory, struct SundialsBlock *block) {
  while (block != NULL) {
    struct SundialsBlock *next = block->next;
    memory->free(block);
    block = next;
  }
}

bool sundials_run(struct Instance *instance, void (*task)(void *argument), void *argument) {
  struct SundialsMemory *own = instance->solver_memory;
  struct SundialsCall *const outer = current;
  struct SundialsCall running = {.memory = &instance->memory, .blocks = own != NULL ? own->blocks : NULL};
  current = &running;
  if (setjmp(running.out_of_memory) != 0) {
    current = outer;
    free_all(&instance->memory, running.blocks);
    instance->solver_memory = NULL;
    return false;
  }
  task(argument);
  current = outer;
  own = instance->solver_memory;
  if (own != NULL) own->blocks = running.blocks;
  else free_all(&instance->memory, running.blocks);
  return true;
}

void sundials_destroy(struct Instance *instance) {
  const struct SundialsMemory *own = instance->solver_memory;
  free_all(&instance->memory, own->blocks);
  instance->solver_memory = NULL;
}

void *sundials_allocate(size_t count, size_t size) {
  size_t limit = SIZE_MAX - sizeof(struct SundialsBlock);
  struct SundialsBlock *block = NULL;
  if (size == 0 || count <= limit / size) block = current->memory->allocate(1, sizeof *block + count * size);
  if (block == NULL) longjmp(current->out_of_memory, 1);
  *block = (struct SundialsBlock){.next = current->blocks, .size = count * size};
  if (block->next != NULL) block->next->previous = block;
  current->blocks = block;
  return block->content;
}

static struct SundialsBlock *block_of(void *content) {
  return (struct SundialsBlock *)((char *)content - offsetof(struct SundialsBlock, content));
}

/* The linker sends SUNDIALS' calls of malloc, calloc, realloc and free to these. */
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *content, size_t size);
void __wrap_free(void *content);

void *__wrap_malloc(size_t size) {
  return sundials_allocate(1, size);
}

void *__wrap_calloc(size_t count, size_t size) {
  return sundials_allocate(count, size);
}

void __wrap_free(void *content) {
  if (content == NULL) return;
  struct SundialsBlock *block = block_of(content);
  if (block->previous != NULL) block->previous->next = block->next;
  else current->blocks = block->next;
  if (block->next != NULL) block->next->previous = block->previous;
  current->memory->free(block);
}

void *__wrap_realloc(void *content, size_t size) {
  void *resized = sundials_allocate(1, size);
  if (content != NULL) {
    size_t before = block_of(content)->size;
    memcpy(resized, content, before < size ? before : size);
    __wrap_free(content);
  }
  return resized;
}
