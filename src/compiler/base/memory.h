/*
 * Memory for a compiler that runs once: blocks last until the program ends, and only large scratch space is released
 * earlier. No function returns NULL: if an allocation fails, the handler of on_memory_failure() is called.
 */
#pragma once

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

/* Sets the handler of failed allocations, which must not return. The default aborts. */
void on_memory_failure(void (*function)(void));

/* Returns count zeroed elements of size bytes. */
void *allocate(size_t count, size_t size);

/* Resizes a block to count elements of size bytes. New bytes are not initialized. */
void *reallocate(void *content, size_t count, size_t size);

/* Frees a block; NULL is allowed. */
void release(void *content);

/* Frees all blocks, so that a program can compile another system. */
void release_all(void);

/*
 * Returns the items of a list with room for one more than count, each of size bytes. The list starts as NULL and grows
 * only by this function: the capacity doubles at each power of two. New bytes are not initialized.
 */
void *make_room(void *items, size_t count, size_t size);

/* Appends an item to such a list. */
#define APPEND(items, count, ...)                                                                                      \
  ((items) = make_room(items, count, sizeof *(items)), (items)[(count)++] = (__VA_ARGS__))

/* A string while it is written. */
struct TextStream {
  FILE *file;
  char *content;
  size_t length;
};

/* Begin and end writing to a string: open_text() returns the stream, close_text() the string. */
FILE *open_text(struct TextStream *text);
char *close_text(struct TextStream *text);

/* Returns a copy of the text. */
char *copy_text(const char *text);

/* Returns a new string, formatted as by printf. */
char *format_text(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Does the same with a list of arguments. */
char *format_arguments(const char *format, va_list arguments) __attribute__((format(printf, 1, 0)));
