#include "base/memory.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/platform.h"

/* A block of memory. All blocks form a ring, which starts and ends at `ring`. */
struct MemoryBlock {
  struct MemoryBlock *previous, *next;
  max_align_t content[];
};

static struct MemoryBlock ring = {&ring, &ring};

static void (*handler)(void) = abort;

void on_memory_failure(void (*function)(void)) {
  handler = function;
}

static _Noreturn void out_of_memory(void) {
  handler();
  abort();
}

static struct MemoryBlock *block_of(void *content) {
  return (struct MemoryBlock *)((char *)content - offsetof(struct MemoryBlock, content));
}

static size_t bytes_of(size_t count, size_t size) {
  if (size > 0 && count > (SIZE_MAX - sizeof(struct MemoryBlock)) / size) out_of_memory();
  return sizeof(struct MemoryBlock) + count * size;
}

static void *insert(struct MemoryBlock *block) {
  if (block == NULL) out_of_memory();
  *block = (struct MemoryBlock){.previous = ring.previous, .next = &ring};
  ring.previous->next = block;
  ring.previous = block;
  return block->content;
}

static void *take_out(struct MemoryBlock *block) {
  block->previous->next = block->next;
  block->next->previous = block->previous;
  return block;
}

void *allocate(size_t count, size_t size) {
  return insert(calloc(1, bytes_of(count, size)));
}

void *reallocate(void *content, size_t count, size_t size) {
  return insert(realloc(content != NULL ? take_out(block_of(content)) : NULL, bytes_of(count, size)));
}

void release(void *content) {
  if (content != NULL) free(take_out(block_of(content)));
}

void release_all(void) {
  for (struct MemoryBlock *block = ring.next, *next = NULL; block != &ring; block = next) {
    next = block->next;
    free(block);
  }
  ring.previous = ring.next = &ring;
}

void *make_room(void *items, size_t count, size_t size) {
  bool is_full = (count & (count - 1)) == 0;
  return is_full ? reallocate(items, count > 0 ? 2 * count : 1, size) : items;
}

FILE *open_text(struct TextStream *text) {
  text->file = open_text_stream(&text->content, &text->length);
  if (text->file == NULL) out_of_memory();
  return text->file;
}

char *close_text(struct TextStream *text) {
  if (!close_text_stream(text->file, &text->content, &text->length)) out_of_memory();
  char *content = memcpy(allocate(text->length + 1, 1), text->content, text->length);
  free(text->content);
  return content;
}

char *copy_text(const char *text) {
  size_t bytes = strlen(text) + 1;
  char *copy = allocate(bytes, 1);
  memcpy(copy, text, bytes);
  return copy;
}

char *format_arguments(const char *format, va_list arguments) {
  va_list again;
  va_copy(again, arguments);
  int length = vsnprintf(NULL, 0, format, arguments);
  char *text = allocate((size_t)(length < 0 ? 0 : length) + 1, 1);
  vsnprintf(text, (size_t)(length < 0 ? 0 : length) + 1, format, again);
  va_end(again);
  return text;
}

char *format_text(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  char *text = format_arguments(format, arguments);
  va_end(arguments);
  return text;
}
