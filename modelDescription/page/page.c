#include "page.h"

#include <string.h>

#include "algebra/formula.h"
#include "base/memory.h"
#include "mathml.h"
#include "xml_output.h"

void page_element(const struct Page *page, const char *name, const char *text) {
  xmlTextWriterWriteElement(page->writer, BAD_CAST name, BAD_CAST text);
}

void page_heading(struct Page *page, const char *heading) {
  page->headings = make_room(page->headings, page->heading_count, sizeof *page->headings);
  page->headings[page->heading_count++] = heading;
  xmlTextWriterStartElement(page->writer, BAD_CAST "h2");
  xmlTextWriterWriteFormatAttribute(page->writer, BAD_CAST "id", "section%zu", page->heading_count);
  xmlTextWriterWriteString(page->writer, BAD_CAST heading);
  xmlTextWriterEndElement(page->writer);
}

/* Writes a folded text: a copy of the formula above, or a formula that is too long to typeset. */
static void write_text(const struct Page *page, const char *summary, const char *text) {
  xmlTextWriterStartElement(page->writer, BAD_CAST "details");
  page_element(page, "summary", summary);
  page_element(page, "code", text);
  xmlTextWriterEndElement(page->writer);
}

/* Returns the right side; the name of a definition if it is equal to one. */
static char *right_side(const struct Page *page, const char *left, Node right) {
  const struct NodeNames *names = &page->summary->names;
  const char *name = right < names->count ? names->of[right] : NULL;
  if (name != NULL && strcmp(name, left) != 0) return copy_text(name);
  return expression_text_with_names(page->model->graph, right, names);
}

void page_equation(const struct Page *page, const char *left, Node right) {
  char *expression = right_side(page, left, right);
  char *text = format_text("%s = %s", left, expression);
  char *math = mathml_of_equation(text);
  xmlTextWriterStartElement(page->writer, BAD_CAST "div");
  write_attribute(page->writer, "class", math != NULL ? "equation" : "long equation");
  if (math != NULL) {
    xmlTextWriterStartElement(page->writer, BAD_CAST "p");
    write_attribute(page->writer, "class", "formula");
    xmlTextWriterWriteRaw(page->writer, BAD_CAST math);
    xmlTextWriterEndElement(page->writer);
    write_text(page, "as text", text);
  } else {
    char *summary = strlen(left) > 40 ? copy_text("a long equation; click to see it")
                                      : format_text("%s = ..., a long equation; click to see it", left);
    write_text(page, summary, text);
  }
  xmlTextWriterEndElement(page->writer);
}

void page_rest(const struct Page *page, size_t count, size_t shown, const char *things) {
  if (count == shown) return;
  char *text = format_text("%zu further %s are not shown.", count - shown, things);
  page_element(page, "p", text);
}
