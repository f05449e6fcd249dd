#include "diagnostics.h"

#include <stdarg.h>
#include <stdio.h>

static void print_message(const struct Diagnostics *diagnostics, long line, const char *kind, const char *format,
                          va_list arguments) {
  fprintf(stderr, "%s:", diagnostics->file);
  if (line > 0) fprintf(stderr, "%ld:", line);
  fprintf(stderr, " %s", kind);
  vfprintf(stderr, format, arguments);
  fprintf(stderr, "%s\n", diagnostics->origin != NULL ? diagnostics->origin : "");
}

void report_error(struct Diagnostics *diagnostics, long line, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  if (diagnostics->errors < ERROR_LIMIT) print_message(diagnostics, line, "", format, arguments);
  va_end(arguments);
  if (++diagnostics->errors == ERROR_LIMIT + 1)
    fprintf(stderr, "%s: there are more mistakes; expected these to be mended first\n", diagnostics->file);
}

void report_warning(const struct Diagnostics *diagnostics, long line, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  print_message(diagnostics, line, "warning: ", format, arguments);
  va_end(arguments);
}
