#include "read/elements/table_lines.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "read/context/includes.h"

static const char blanks[] = " \t\r";

double *table_numbers(const char *line, size_t *count, const char **rest) {
  double *numbers = NULL;
  *count = 0;
  *rest = line + strspn(line, blanks);
  for (const char *next = *rest; *next != '\0';) {
    char *end;
    double number = strtod(next, &end);
    const char *after = end + strspn(end, blanks);
    if (end == next || (*after != '\0' && *after != ',' && *after != ';' && after == end)) break;
    APPEND(numbers, *count, number);
    *rest = next = after;
    if (*after == ',' || *after == ';') next = after + 1 + strspn(after + 1, blanks);
  }
  return numbers;
}

static void take_lines(struct TableLines *lines, const char *text) {
  while (*text != '\0' && !lines->wrong) {
    size_t length = strcspn(text, "\n");
    char *line = format_text("%.*s", (int)length, text);
    line[strcspn(line, "#")] = '\0';
    const char *start = line + strspn(line, blanks);
    if (*start != '\0') {
      lines->take(lines, start);
      lines->is_heading = false;
    }
    text += length;
    lines->line += *text == '\n';
    text += *text == '\n';
  }
}

static char *text_of_file(const char *path) {
  FILE *file = fopen(path, "r");
  if (file == NULL) return NULL;
  struct TextStream text;
  FILE *copy = open_text(&text);
  for (int c = getc(file); c != EOF && c != '\0'; c = getc(file)) putc(c, copy);
  bool right = ferror(file) == 0;
  fclose(file);
  char *whole = close_text(&text);
  return right ? whole : NULL;
}

void table_lines_of_file(struct TableLines *lines, xmlNodePtr node, const char *name) {
  struct Diagnostics *diagnostics = lines->reader->diagnostics;
  char *path = path_beside(lines->reader, name), *text = text_of_file(path);
  if (text == NULL) {
    report_error(diagnostics, line_of(node),
                 "the file '%s' cannot be read: %s; expected columns of numbers, and a path relative to this file",
                 path, strerror(errno));
    lines->wrong = true;
  } else {
    const char *present = diagnostics->file;
    diagnostics->file = path;
    lines->line = 1;
    lines->is_heading = true;
    take_lines(lines, text);
    lines->is_heading = false;
    diagnostics->file = present;
  }
}

void table_lines_of_text(struct TableLines *lines, xmlNodePtr part) {
  lines->line = line_of(part);
  take_lines(lines, (const char *)part->content);
}
