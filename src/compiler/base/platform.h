/* Functions that depend on the operating system. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Returns a stream into memory, or NULL without memory. close_text_stream() completes the string *text. */
FILE *open_text_stream(char **text, size_t *length);

/*
 * Closes the stream; takes the pointers of open_text_stream(). The caller frees *text by free(). False without memory.
 */
bool close_text_stream(FILE *file, char **text, size_t *length);

/* Creates a directory in an existing one. True if it exists afterwards; else errno is set. */
bool make_directory(const char *path);

/* Returns the canonical absolute path of a file, to be freed by free(); NULL with errno set if there is none. */
char *resolve_path(const char *path);

/* Return the first and the last separator of a path, / or on Windows also \; NULL if there is none. */
char *first_separator(char *path);
const char *last_separator(const char *path);

/* True if the path is absolute. */
bool is_absolute(const char *path);

/*
 * Limits the address space of the process to this number of bytes, if the system supports that and no sanitizer is in
 * use.
 */
void limit_memory(size_t bytes);

/* Makes standard output end lines by \n on every system. */
void write_plain_lines(void);
