/* Messages to the author of a file: "file:line: what is wrong, and what was expected". */
#pragma once

#include <stdarg.h>
#include <stddef.h>

/* Most errors shown for a file: an error inside a loop may repeat ten thousand times. Counted from 1 more, none is. */
enum { ERROR_LIMIT = 100 };

/* A line of a file, for messages that are printed while another file is read, or later. */
struct FileLine {
  const char *file, *origin; /* as in struct Diagnostics */
  long line;
};

/* Lines of files other than the user's own file, the system itself. */
struct FileLines {
  const char *own;
  struct FileLine *items;
  size_t count;
};

/*
 * The destination of the messages about a file, and the number of errors. Readers of included files have their own file
 * and origin.
 */
struct Diagnostics {
  const char *file;        /* the file being read, as named by the user */
  const char *origin;      /* says how the file is included, for the end of messages; NULL for the user's own */
  struct FileLines *noted; /* shared by all readers of a system's files; NULL if no file is read */
  int errors;
  char *reported[ERROR_LIMIT]; /* errors reported so far, each once; NULL at the end */
};

/*
 * Returns a number for a line of the current file, for later messages: the line itself in the user's own file, else a
 * negative number. All functions below accept both.
 */
long note_line(const struct Diagnostics *diagnostics, long line);

/* Returns the file and the line of such a number. */
struct FileLine noted_line(const struct FileLines *noted, long line);

/* Returns the same with the name of the current file; the line is for a message that names a second place. */
struct FileLine file_line(const struct Diagnostics *diagnostics, long line);

/* Prints an error to stderr, up to ERROR_LIMIT different ones, and counts it. line is 0 if unknown. */
void report_error(struct Diagnostics *diagnostics, long line, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Does the same with a list of arguments. */
void report_error_of(struct Diagnostics *diagnostics, long line, const char *format, va_list arguments)
    __attribute__((format(printf, 3, 0)));

/* Prints to stderr a note: nothing is wrong. */
void report_note(const struct Diagnostics *diagnostics, long line, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Prints a warning to stderr. */
void report_warning(const struct Diagnostics *diagnostics, long line, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
