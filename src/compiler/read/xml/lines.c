#include "read/xml/lines.h"

#include <stdbool.h>
#include <string.h>

#include "base/memory.h"
#include "read/xml/nodes.h"

/* Lines beyond are not numbered by libxml2. */
enum { LINE_LIMIT = 65535 };

/* In the psvi of a node, which libxml2 leaves free; content is that of an element. */
struct NodeLines {
  long first, content;
};

/* In the psvi of an attribute. */
struct AttributeLines {
  long first;
  size_t *breaks; /* where in the value a blank stands for a line break */
  size_t break_count;
};

/* Where reading stands; wrong where the text and the document do not agree. */
struct Scan {
  const char *next, *end;
  long line;
  bool wrong;
};

static bool begins(const struct Scan *scan, const char *text) {
  size_t length = strlen(text);
  return (size_t)(scan->end - scan->next) >= length && memcmp(scan->next, text, length) == 0;
}

static void pass(struct Scan *scan) {
  scan->line += *scan->next == '\n';
  scan->next++;
}

static void pass_to(struct Scan *scan, const char *text) {
  while (scan->next < scan->end && !begins(scan, text)) pass(scan);
}

static void pass_behind(struct Scan *scan, const char *text) {
  pass_to(scan, text);
  if (scan->next < scan->end) scan->next += strlen(text);
  else scan->wrong = true;
}

static void pass_any(struct Scan *scan, const char *characters) {
  while (scan->next < scan->end && strchr(characters, *scan->next) != NULL) pass(scan);
}

/* Copies of the node keep the line that libxml2 has room for. */
static void set_lines(xmlNodePtr node, long first, long content) {
  struct NodeLines *lines = allocate(1, sizeof *lines);
  *lines = (struct NodeLines){first, content};
  node->line = (unsigned short)(first < LINE_LIMIT ? first : LINE_LIMIT);
  node->psvi = lines;
}

void set_line(xmlNodePtr node, long line) {
  set_lines(node, line, line);
}

/* Passes a value up to its quote and finds its line breaks; each character that is not one, or stands for one, counts. */
static void find_breaks(struct Scan *scan, char quote, struct AttributeLines *lines) {
  size_t place = 0;
  for (; scan->next < scan->end && *scan->next != quote; pass(scan)) {
    if (*scan->next == '\n') {
      lines->breaks = make_room(lines->breaks, lines->break_count, sizeof *lines->breaks);
      lines->breaks[lines->break_count++] = place;
    } else if (*scan->next == '&') pass_to(scan, ";");
    if (scan->next == scan->end) break;
    bool continues = ((unsigned char)*scan->next & 0xC0u) == 0x80u, is_in_break = begins(scan, "\r\n");
    place += !continues && !is_in_break;
  }
}

static xmlAttrPtr attribute_named(const xmlNode *element, const char *name, size_t length) {
  for (xmlAttrPtr found = element->properties; found != NULL; found = found->next)
    if (strlen((const char *)found->name) == length && memcmp(found->name, name, length) == 0) return found;
  return NULL;
}

static void find_attribute(struct Scan *scan, xmlNodePtr element) {
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

/* Passes a text, of which a <![CDATA[ ]]> is a part. */
static void pass_text(struct Scan *scan) {
  for (pass_to(scan, "<"); begins(scan, "<![CDATA["); pass_to(scan, "<")) pass_behind(scan, "]]>");
}

static void find_in_content(struct Scan *scan, xmlNodePtr first);

static void find_in_element(struct Scan *scan, xmlNodePtr element) {
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
  pass_behind(scan, ">");
  set_lines(element, first, scan->line);
  if (is_empty) return;
  find_in_content(scan, element->children);
  pass_text(scan);
  scan->wrong |= !begins(scan, "</");
  pass_behind(scan, ">");
}

static void find_in_content(struct Scan *scan, xmlNodePtr first) {
  for (xmlNodePtr node = first; node != NULL && !scan->wrong; node = node->next) {
    if (node->type == XML_TEXT_NODE) set_line(node, scan->line);
    pass_text(scan);
    if (node->type == XML_TEXT_NODE) continue;
    scan->wrong |= scan->next == scan->end;
    if (scan->wrong) return;
    if (node->type == XML_ELEMENT_NODE) find_in_element(scan, node);
    else {
      set_line(node, scan->line);
      pass_behind(scan, node->type == XML_COMMENT_NODE ? "-->" : "?>");
    }
  }
}

void lines_find(xmlDocPtr document, const char *text, size_t length) {
  struct Scan scan = {.next = text, .end = text + length, .line = 1};
  pass_to(&scan, "<");
  if (begins(&scan, "<?xml ")) pass_behind(&scan, "?>");
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

/* The length of a letter in UTF-8. */
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
  for (size_t i = 0, place = 0; i < lines->break_count; i++) {
    for (; place < lines->breaks[i] && *letter != '\0'; place++) letter += letter_length(letter);
    if (*letter == ' ') *letter = '\n';
  }
  return text;
}
