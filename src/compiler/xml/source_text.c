#include "xml/source_text.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"

/*
 * Limits in bytes, elements per file and attributes per element. They bound quadratic costs of libxml2: it compares the
 * attributes of an element pairwise, and each message of its validator counts all preceding elements.
 */
enum { LENGTH_LIMIT = 10000000, ELEMENT_LIMIT = 40000, ATTRIBUTE_LIMIT = 200 };

/* The reading position, with the numbers of elements in the file and of attributes in the current element. */
struct TextScan {
  const char *next, *end;
  long line;
  size_t elements, attributes;
};

static bool begins(const struct TextScan *scan, const char *text) {
  size_t length = strlen(text);
  return (size_t)(scan->end - scan->next) >= length && memcmp(scan->next, text, length) == 0;
}

static char pass(struct TextScan *scan) {
  scan->line += *scan->next == '\n';
  return *scan->next++;
}

/* Advances to the end of the next occurrence of the text. */
static void pass_after(struct TextScan *scan, const char *text) {
  while (scan->next < scan->end && !begins(scan, text)) pass(scan);
  if (scan->next < scan->end) scan->next += strlen(text);
}

/* Advances to the end of a tag. Quoted values may contain '>'. */
static void pass_tag(struct TextScan *scan) {
  char quote = '\0';
  scan->attributes = 0;
  while (scan->next < scan->end) {
    char c = pass(scan);
    if (quote != '\0') quote = c == quote ? '\0' : quote;
    else if (c == '"' || c == '\'') quote = c;
    else if (c == '>') return;
    else scan->attributes += c == '=';
  }
}

/*
 * Advances past a tag, comment, CDATA section or processing instruction. Each counts as an element, because libxml2
 * makes a node of it. Returns false after reporting that a limit is exceeded.
 */
static bool pass_markup(struct TextScan *scan, struct Diagnostics *diagnostics) {
  long line = scan->line;
  scan->elements += !begins(scan, "</");
  scan->attributes = 0;
  if (begins(scan, "<!--")) pass_after(scan, "-->");
  else if (begins(scan, "<![CDATA[")) pass_after(scan, "]]>");
  else if (begins(scan, "<?")) pass_after(scan, "?>");
  else pass_tag(scan);
  if (scan->elements > ELEMENT_LIMIT)
    report_error(diagnostics, line, "the file has more than %d elements; expected fewer, and <for> for repetitions",
                 ELEMENT_LIMIT);
  else if (scan->attributes > ATTRIBUTE_LIMIT)
    report_error(diagnostics, line, "an element has more than %d attributes; expected fewer", ATTRIBUTE_LIMIT);
  return scan->elements <= ELEMENT_LIMIT && scan->attributes <= ATTRIBUTE_LIMIT;
}

static bool is_readable(const char *text, size_t length, struct Diagnostics *diagnostics) {
  struct TextScan scan = {.next = text, .end = text + length, .line = 1};
  while (scan.next < scan.end)
    if (*scan.next != '<') pass(&scan);
    else if (!pass_markup(&scan, diagnostics)) return false;
  return true;
}

/* True if the text names an encoding other than UTF-8; libxml2 must read that. */
static bool names_encoding(const struct TextScan *scan) {
  struct TextScan name = *scan;
  pass_after(&name, "encoding");
  while (name.next < name.end && strchr("= \t\r\n\"'", *name.next) != NULL) name.next++;
  return name.next < name.end && !begins(&name, "utf-8") && !begins(&name, "UTF-8");
}

/*
 * Replaces <?xml ...?> by blanks, with a warning, if only its position or its version is wrong. It may follow blank
 * lines or comments, or have a version below 1.
 */
static void blank_declaration(char *text, size_t length, const struct Diagnostics *diagnostics) {
  struct TextScan scan = {.next = text, .end = text + length, .line = 1};
  while (scan.next < scan.end && (strchr(" \t\r\n", *scan.next) != NULL || begins(&scan, "<!--")))
    if (*scan.next != '<') pass(&scan);
    else pass_after(&scan, "-->");
  if (!begins(&scan, "<?xml ")) return;
  struct TextScan end = scan, version = scan;
  pass_after(&end, "?>");
  version.end = scan.end = end.next;
  pass_after(&version, "version=");
  bool is_late = scan.next != text, is_old = end.next - version.next > 2 && version.next[1] == '0';
  if (names_encoding(&scan) || !(is_late || is_old)) return;
  report_warning(diagnostics, scan.line,
                 is_late ? "<?xml ...?> stands further down; expected it at the very beginning of the file, or left out"
                         : "the first line names a version of XML other than 1.0; expected <?xml version=\"1.0\"?>, or "
                           "no such line");
  for (char *c = text + (scan.next - text); c < end.next; c++)
    if (*c != '\n') *c = ' ';
}

char *source_text(const char *path, size_t *length, struct Diagnostics *diagnostics) {
  FILE *file = fopen(path, "rb");
  if (file == NULL) return NULL;
  char *text = allocate(LENGTH_LIMIT + 1, 1);
  *length = fread(text, 1, LENGTH_LIMIT + 1, file);
  bool is_right = ferror(file) == 0;
  fclose(file);
  if (is_right && *length > LENGTH_LIMIT)
    report_error(diagnostics, 0, "the file is longer than %d bytes; expected a shorter one, and <for> for repetitions",
                 LENGTH_LIMIT);
  if (is_right && *length <= LENGTH_LIMIT && is_readable(text, *length, diagnostics)) {
    blank_declaration(text, *length, diagnostics);
    return text;
  }
  release(text);
  return NULL;
}
