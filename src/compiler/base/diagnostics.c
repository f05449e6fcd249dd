#include "base/diagnostics.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"

/* What a message says of a very long text has room before and behind what it leaves out. */
enum { HEAD_LENGTH = 600, TAIL_LENGTH = 400 };

static bool continues_letter(char byte) {
  return ((unsigned char)byte & 0xC0u) == 0x80u;
}

static void print_text(const char *text) {
  size_t length = strlen(text), head = HEAD_LENGTH;
  if (length <= HEAD_LENGTH + TAIL_LENGTH) {
    fputs(text, stderr);
    return;
  }
  const char *tail = text + length - TAIL_LENGTH;
  while (head > 0 && continues_letter(text[head])) head--;
  while (continues_letter(*tail)) tail++;
  fprintf(stderr, "%.*s ... %s", (int)head, text, tail);
}

static void print_message(const struct Diagnostics *diagnostics, long line, const char *kind, const char *text) {
  fprintf(stderr, "%s:", diagnostics->file);
  if (line > 0) fprintf(stderr, "%ld:", line);
  fprintf(stderr, " %s", kind);
  print_text(text);
  fprintf(stderr, "%s\n", diagnostics->origin != NULL ? diagnostics->origin : "");
}

void report_error(struct Diagnostics *diagnostics, long line, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  report_error_of(diagnostics, line, format, arguments);
  va_end(arguments);
}

/* Notes an error, where there is room; false for one that was noted before. */
static bool note_told(struct Diagnostics *diagnostics, char *error) {
  int i = 0;
  while (i < ERROR_LIMIT && diagnostics->told[i] != NULL && strcmp(diagnostics->told[i], error) != 0) i++;
  if (i == ERROR_LIMIT) return true;
  bool is_new = diagnostics->told[i] == NULL;
  diagnostics->told[i] = error;
  return is_new;
}

/* What is read in several places, as the stiffness of a spring, is wrong in each. */
void report_error_of(struct Diagnostics *diagnostics, long line, const char *format, va_list arguments) {
  char *text = format_arguments(format, arguments), *error = format_text("%s:%ld:%s", diagnostics->file, line, text);
  if (note_told(diagnostics, error) && diagnostics->errors < ERROR_LIMIT) print_message(diagnostics, line, "", text);
  if (++diagnostics->errors == ERROR_LIMIT + 1)
    fprintf(stderr, "%s: there are more mistakes; correct these first\n", diagnostics->file);
}

void report_warning(const struct Diagnostics *diagnostics, long line, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  print_message(diagnostics, line, "warning: ", format_arguments(format, arguments));
  va_end(arguments);
}
