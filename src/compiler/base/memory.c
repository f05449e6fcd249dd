#include "base/memory.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/platform.h"

static void (*handler)(void) = abort;

void on_memory_failure(void (*function)(void)) {
  handler = function;
}

static _Noreturn void out_of_memory(void) {
  handler();
  abort();
}

void *allocate(size_t count, size_t size) {
  void *block = calloc(count > 0 ? count : 1, size);
  if (block == NULL) out_of_memory();
  return block;
}

void *reallocate(void *block, size_t count, size_t size) {
  if (size > 0 && count > SIZE_MAX / size) out_of_memory();
  void *resized = realloc(block, count * size > 0 ? count * size : 1);
  if (resized == NULL) out_of_memory();
  return resized;
}

void *make_room(void *items, size_t count, size_t size) {
  bool is_full = (count & (count - 1)) == 0;
  return is_full ? reallocate(items, count > 0 ? 2 * count : 1, size) : items;
}

FILE *open_text(char **text, size_t *length) {
  FILE *file = open_text_stream(text, length);
  if (file == NULL) out_of_memory();
  return file;
}

void close_text(FILE *file, char **text, size_t *length) {
  if (!close_text_stream(file, text, length)) out_of_memory();
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
