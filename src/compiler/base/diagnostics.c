#include "base/diagnostics.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"

/* Bytes of a longer text that a message shows: its beginning and its end. */
enum { HEAD_LENGTH = 600, TAIL_LENGTH = 400 };

/* Number of latest lines among which note_line() looks for an equal one. */
enum { RECENT_LINES = 64 };

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

long note_line(const struct Diagnostics *diagnostics, long line) {
  struct FileLines *noted = diagnostics->noted;
  if (noted == NULL || line <= 0 || strcmp(diagnostics->file, noted->own) == 0) return line;
  for (size_t i = noted->count; i > 0 && noted->count - i < RECENT_LINES; i--)
    if (noted->items[i - 1].file == diagnostics->file && noted->items[i - 1].line == line) return -(long)i;
  APPEND(noted->items, noted->count, (struct FileLine){diagnostics->file, diagnostics->origin, line});
  return -(long)noted->count;
}

struct FileLine noted_line(const struct FileLines *noted, long line) {
  return line < 0 ? noted->items[-line - 1] : (struct FileLine){.file = noted->own, .line = line};
}

struct FileLine file_line(const struct Diagnostics *diagnostics, long line) {
  if (line < 0) return noted_line(diagnostics->noted, line);
  return (struct FileLine){diagnostics->file, diagnostics->origin, line};
}

static void print_message(const struct FileLine *location, const char *kind, const char *text) {
  fprintf(stderr, "%s:", location->file);
  if (location->line > 0) fprintf(stderr, "%ld:", location->line);
  fprintf(stderr, " %s", kind);
  print_text(text);
  fprintf(stderr, "%s\n", location->origin != NULL ? location->origin : "");
}

void report_error(struct Diagnostics *diagnostics, long line, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  report_error_of(diagnostics, line, format, arguments);
  va_end(arguments);
}

/* Adds an error to those reported, if there is room; false if it is already there. */
static bool note_reported(struct Diagnostics *diagnostics, char *error) {
  int i = 0;
  while (i < ERROR_LIMIT && diagnostics->reported[i] != NULL && strcmp(diagnostics->reported[i], error) != 0) i++;
  if (i == ERROR_LIMIT) return true;
  bool is_new = diagnostics->reported[i] == NULL;
  diagnostics->reported[i] = error;
  return is_new;
}

/* One text may be read in several contexts, such as the stiffness of a spring; its error is reported once. */
void report_error_of(struct Diagnostics *diagnostics, long line, const char *format, va_list arguments) {
  struct FileLine location = file_line(diagnostics, line);
  char *text = format_arguments(format, arguments),
       *error = format_text("%s:%ld:%s", location.file, location.line, text);
  if (note_reported(diagnostics, error) && diagnostics->errors < ERROR_LIMIT) print_message(&location, "", text);
  if (++diagnostics->errors == ERROR_LIMIT + 1)
    fprintf(stderr, "%s: more errors follow; correct these first\n", diagnostics->file);
}

static void report_kind(const struct Diagnostics *diagnostics, long line, const char *kind, const char *format,
                        va_list arguments) {
  struct FileLine location = file_line(diagnostics, line);
  print_message(&location, kind, format_arguments(format, arguments));
}

void report_note(const struct Diagnostics *diagnostics, long line, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  report_kind(diagnostics, line, "note: ", format, arguments);
  va_end(arguments);
}

void report_warning(const struct Diagnostics *diagnostics, long line, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  report_kind(diagnostics, line, "warning: ", format, arguments);
  va_end(arguments);
}
