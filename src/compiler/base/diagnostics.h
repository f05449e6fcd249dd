/* Messages for the person who wrote the file: "file:line: what is wrong, and what was expected". */
#pragma once

#include <stdarg.h>
#include <stddef.h>

/* As many errors of one file are shown: a mistake in a loop would be told ten thousand times. */
enum { ERROR_LIMIT = 100 };

/* A line of a file, for messages that come when another file is read, or all have been. */
struct FileLine {
  const char *file, *origin; /* as in struct Diagnostics */
  long line;
};

/* Lines of other files than the user's own, that of the system. */
struct FileLines {
  const char *own;
  struct FileLine *items;
  size_t count;
};

struct Diagnostics {
  const char *file;        /* the file being read, as named by the user */
  const char *origin;      /* how it comes to be read, for the end of messages; NULL for the user's own */
  struct FileLines *noted; /* shared by all that read files of a system; NULL where none is read */
  int errors;
  char *told[ERROR_LIMIT]; /* errors, none of which is told twice */
};

/*
 * Returns a number for a line of the file being read, for later messages: the line itself in the user's own file, else a
 * negative number. All functions below take both.
 */
long note_line(const struct Diagnostics *diagnostics, long line);

/* The file and the line that such a number stands for. */
struct FileLine noted_line(const struct FileLines *noted, long line);

/* Prints an error to stderr, unless there have been many, and counts it; line 0 where no line can be named. */
void report_error(struct Diagnostics *diagnostics, long line, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The same with the arguments that a caller was given. */
void report_error_of(struct Diagnostics *diagnostics, long line, const char *format, va_list arguments)
    __attribute__((format(printf, 3, 0)));

/* Prints to stderr what is right, but good to know. */
void report_note(const struct Diagnostics *diagnostics, long line, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Prints a warning to stderr. */
void report_warning(const struct Diagnostics *diagnostics, long line, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
