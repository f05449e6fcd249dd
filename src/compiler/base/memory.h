/*
 * Memory for a compiler that runs once: it lasts until the end of the program, and only large scratch space is given back before.
 * After an allocation that fails nothing goes on, but for what main says.
 */
#pragma once

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

/* What is called when an allocation fails; it must not return. Without it the program aborts. */
void on_memory_failure(void (*function)(void));

/* count zeroed elements of size bytes; never NULL. */
void *allocate(size_t count, size_t size);

/* Resizes a block to count elements of size bytes; new bytes are not initialised; never NULL. */
void *reallocate(void *content, size_t count, size_t size);

/* Gives a block back; nothing for NULL. */
void release(void *content);

/* Gives all blocks back, so that a program may compile another system. */
void release_all(void);

/*
 * The items of a list, each of size bytes, with room for one behind the count that are there. It begins as NULL and grows by
 * this alone: at every power of two the room is doubled. New bytes are not initialised; never NULL.
 */
void *make_room(void *items, size_t count, size_t size);

/* A string that is being written. */
struct TextStream {
  FILE *file;
  char *content;
  size_t length;
};

/* The stream to write it with; never NULL. close_text() returns the string. */
FILE *open_text(struct TextStream *text);
char *close_text(struct TextStream *text);

char *copy_text(const char *text);

/* printf into a new string. */
char *format_text(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* The same with the arguments that a caller was given. */
char *format_arguments(const char *format, va_list arguments) __attribute__((format(printf, 1, 0)));
