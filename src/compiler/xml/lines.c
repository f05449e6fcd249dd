#include "xml/lines.h"

#include <stdbool.h>
#include <string.h>

#include "base/memory.h"
#include "xml/nodes.h"

/* Largest line number in the 16-bit field `line` of libxml2's nodes. */
enum { LINE_LIMIT = 65535 };

/*
 * Lines of an element (first and content) or of another node (both equal), in the node's field `psvi`, which libxml2
 * leaves unused.
 */
struct NodeLines {
  long first, content;
};

/* Lines of an attribute's value, in the attribute's field `psvi`. */
struct AttributeLines {
  long first;
  size_t *breaks; /* character offsets in the value at which a blank replaces a line break */
  size_t break_count;
};

/* The reading position in the source text. `wrong` is set when text and document disagree, which ends the scan. */
struct LineScan {
  const char *next, *end;
  long line;
  bool wrong;
};

static bool begins(const struct LineScan *scan, const char *text) {
  size_t length = strlen(text);
  return (size_t)(scan->end - scan->next) >= length && memcmp(scan->next, text, length) == 0;
}

static void pass(struct LineScan *scan) {
  scan->line += *scan->next == '\n';
  scan->next++;
}

static void pass_to(struct LineScan *scan, const char *text) {
  while (scan->next < scan->end && !begins(scan, text)) pass(scan);
}

static void pass_after(struct LineScan *scan, const char *text) {
  pass_to(scan, text);
  if (scan->next < scan->end) scan->next += strlen(text);
  else scan->wrong = true;
}

static void pass_any(struct LineScan *scan, const char *characters) {
  while (scan->next < scan->end && strchr(characters, *scan->next) != NULL) pass(scan);
}

/* Sets the lines of a node, and libxml2's 16-bit field, which copies of a node keep, unlike `psvi`. */
static void set_lines(xmlNodePtr node, long first, long content) {
  struct NodeLines *lines = allocate(1, sizeof *lines);
  *lines = (struct NodeLines){first, content};
  node->line = (unsigned short)(first < LINE_LIMIT ? first : LINE_LIMIT);
  node->psvi = lines;
}

void set_line(xmlNodePtr node, long line) {
  set_lines(node, line, line);
}

/*
 * Advances to the closing quote of an attribute's value and records its line breaks. Offsets count characters of the
 * parsed value: a UTF-8 sequence, an entity and a CR LF pair are one each.
 */
static void find_breaks(struct LineScan *scan, char quote, struct AttributeLines *lines) {
  size_t offset = 0;
  for (; scan->next < scan->end && *scan->next != quote; pass(scan)) {
    if (*scan->next == '\n') {
      APPEND(lines->breaks, lines->break_count, offset);
    } else if (*scan->next == '&') pass_to(scan, ";");
    if (scan->next == scan->end) break;
    bool continues = ((unsigned char)*scan->next & 0xC0u) == 0x80u, is_in_break = begins(scan, "\r\n");
    offset += !continues && !is_in_break;
  }
}

static xmlAttrPtr attribute_named(const xmlNode *element, const char *name, size_t length) {
  for (xmlAttrPtr found = element->properties; found != NULL; found = found->next)
    if (strlen((const char *)found->name) == length && memcmp(found->name, name, length) == 0) return found;
  return NULL;
}

static void find_attribute(struct LineScan *scan, xmlNodePtr element) {
  const char *name = scan->next;
  while (scan->next < scan->end && strchr(" \t\r\n=>", *scan->next) == NULL) scan->next++;
  xmlAttrPtr found = attribute_named(element, name, (size_t)(scan->next - name));
  pass_any(scan, " \t\r\n=");
  char quote = scan->next < scan->end ? *scan->next : '\0';
  scan->wrong |= quote != '"' && quote != '\'';
  if (scan->wrong) return;
  scan->next++;
  struct AttributeLines *lines = allocate(1, sizeof *lines);
  lines->first = scan->line;
  find_breaks(scan, quote, lines);
  if (found != NULL) found->psvi = lines;
  if (scan->next < scan->end) scan->next++;
}

/* Advances to the next markup after a text. CDATA sections are part of the text. */
static void pass_text(struct LineScan *scan) {
  for (pass_to(scan, "<"); begins(scan, "<![CDATA["); pass_to(scan, "<")) pass_after(scan, "]]>");
}

static void find_in_content(struct LineScan *scan, xmlNodePtr first);

static void find_in_element(struct LineScan *scan, xmlNodePtr element) {
  long first = scan->line;
  size_t length = strcspn(++scan->next, " \t\r\n/>");
  const char *name = (const char *)element->name;
  scan->wrong |= strlen(name) > length || memcmp(scan->next + length - strlen(name), name, strlen(name)) != 0;
  scan->next += length;
  while (!scan->wrong && scan->next < scan->end && *scan->next != '>' && *scan->next != '/') {
    pass_any(scan, " \t\r\n");
    if (scan->next < scan->end && *scan->next != '>' && *scan->next != '/') find_attribute(scan, element);
  }
  if (scan->wrong) return;
  bool is_empty = begins(scan, "/>");
  pass_after(scan, ">");
  set_lines(element, first, scan->line);
  if (is_empty) return;
  find_in_content(scan, element->children);
  pass_text(scan);
  scan->wrong |= !begins(scan, "</");
  pass_after(scan, ">");
}

static void find_in_content(struct LineScan *scan, xmlNodePtr first) {
  for (xmlNodePtr node = first; node != NULL && !scan->wrong; node = node->next) {
    if (node->type == XML_TEXT_NODE) set_line(node, scan->line);
    pass_text(scan);
    if (node->type == XML_TEXT_NODE) continue;
    scan->wrong |= scan->next == scan->end;
    if (scan->wrong) return;
    if (node->type == XML_ELEMENT_NODE) find_in_element(scan, node);
    else {
      set_line(node, scan->line);
      pass_after(scan, node->type == XML_COMMENT_NODE ? "-->" : "?>");
    }
  }
}

void lines_find(xmlDocPtr document, const char *text, size_t length) {
  struct LineScan scan = {.next = text, .end = text + length, .line = 1};
  pass_to(&scan, "<");
  if (begins(&scan, "<?xml ")) pass_after(&scan, "?>");
  find_in_content(&scan, document->children);
}

long line_of(const xmlNode *node) {
  return node->psvi != NULL ? ((const struct NodeLines *)node->psvi)->first : xmlGetLineNo(node);
}

static const struct AttributeLines *attribute_lines(const xmlNode *element, const char *name) {
  const xmlAttr *found = name != NULL ? attribute_named(element, name, strlen(name)) : NULL;
  return found != NULL ? found->psvi : NULL;
}

long line_of_attribute(const xmlNode *element, const char *name) {
  const struct AttributeLines *lines = attribute_lines(element, name);
  return lines != NULL ? lines->first : line_of(element);
}

long line_of_content(const xmlNode *element) {
  return element->psvi != NULL ? ((const struct NodeLines *)element->psvi)->content : line_of(element);
}

/* Returns the number of bytes of a UTF-8 character. */
static size_t letter_length(const char *letter) {
  size_t length = 1;
  while (((unsigned char)letter[length] & 0xC0u) == 0x80u) length++;
  return length;
}

char *attribute_in_lines(xmlNodePtr element, const char *name) {
  char *text = attribute(element, name);
  const struct AttributeLines *lines = attribute_lines(element, name);
  if (text == NULL || lines == NULL) return text;
  char *letter = text;
  for (size_t i = 0, offset = 0; i < lines->break_count; i++) {
    for (; offset < lines->breaks[i] && *letter != '\0'; offset++) letter += letter_length(letter);
    if (*letter == ' ') *letter = '\n';
  }
  return text;
}
