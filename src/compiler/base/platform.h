/* What C leaves to the operating system. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* A stream into memory, NULL where there is no memory; what was written becomes a string with close_text_stream(). */
FILE *open_text_stream(char **text, size_t *length);

/* False where there is no memory; else the text is to be freed with free(). Both pointers are those of open_text_stream(). */
bool close_text_stream(FILE *file, char **text, size_t *length);

/* Creates a directory in one that is there; whether it is there afterwards. Else errno tells why. */
bool make_directory(const char *path);

/* The one absolute path of a file, to be freed with free(); NULL where there is no such file, and errno tells why. */
char *resolve_path(const char *path);

/* The first and the last / of a path, or on Windows \; NULL without one. */
char *first_separator(char *path);
const char *last_separator(const char *path);

/* Whether the path does not begin in the present directory. */
bool is_absolute(const char *path);

/* From so many bytes on allocations fail, where the system can do that and no sanitizer needs more. */
void limit_memory(size_t bytes);

/* Makes \n the end of a line on the standard output too. */
void write_plain_lines(void);
