/* Messages for the person who wrote the file: "file:line: what is wrong, and what was expected". */
#pragma once

#include <stdarg.h>

/* As many errors of one file are shown: a mistake in a loop would be told ten thousand times. */
enum { ERROR_LIMIT = 100 };

struct Diagnostics {
  const char *file;   /* the file being read, as named by the user */
  const char *origin; /* how it comes to be read, for the end of messages; NULL for the user's own */
  int errors;
  char *told[ERROR_LIMIT]; /* errors, none of which is told twice */
};

/* Prints an error to stderr, unless there have been many, and counts it; line 0 where no line can be named. */
void report_error(struct Diagnostics *diagnostics, long line, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The same with the arguments that a caller was given. */
void report_error_of(struct Diagnostics *diagnostics, long line, const char *format, va_list arguments)
    __attribute__((format(printf, 3, 0)));

/* Prints a warning to stderr. */
void report_warning(const struct Diagnostics *diagnostics, long line, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
