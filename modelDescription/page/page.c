#include "page.h"

#include <string.h>

#include "algebra/formula.h"
#include "base/memory.h"
#include "latex.h"
#include "xml_output.h"

/* Characters above which an equation of a derivation is left out, and above which an equation is not typeset. */
enum { STEP_LENGTH_LIMIT = 600, TYPESET_LIMIT = 3000 };

void page_element(const struct Page *page, const char *name, const char *text) {
  xmlTextWriterWriteElement(page->writer, BAD_CAST name, BAD_CAST text);
}

void page_paragraph(const struct Page *page, const char *text) {
  if (page->lines != NULL) fprintf(page->lines, "text\t%s\n", text);
  else page_element(page, "p", text);
}

void page_heading(struct Page *page, const char *heading) {
  if (page->lines != NULL) {
    fprintf(page->lines, "heading\t%s\n", heading);
    return;
  }
  APPEND(page->headings, page->heading_count, heading);
  xmlTextWriterStartElement(page->writer, BAD_CAST "h2");
  xmlTextWriterWriteFormatAttribute(page->writer, BAD_CAST "id", "section%zu", page->heading_count);
  xmlTextWriterWriteString(page->writer, BAD_CAST heading);
  xmlTextWriterEndElement(page->writer);
}

/* Returns the right side; the name of a definition if it is equal to one. */
static char *right_side(const struct Page *page, const char *left, Node right) {
  const struct NodeNames *names = &page->summary->names;
  const char *name = right < names->count ? names->of[right] : NULL;
  if (name != NULL && strcmp(name, left) != 0) return copy_text(name);
  return display_text(page->display, right);
}

/* Writes an equation as text, with the LaTeX from which the page's script typesets it. */
static void write_text(const struct Page *page, const char *class, const char *left, const char *right) {
  xmlTextWriterStartElement(page->writer, BAD_CAST "code");
  if (class != NULL) write_attribute(page->writer, "class", class);
  if (strlen(left) + strlen(right) <= TYPESET_LIMIT)
    write_attribute(page->writer, "data-latex", latex_of_equation(page->model, left, right));
  xmlTextWriterWriteFormatString(page->writer, "%s = %s", left, right);
  xmlTextWriterEndElement(page->writer);
}

static void write_equation(const struct Page *page, const char *label, const char *left, const char *right) {
  if (page->lines != NULL) {
    fprintf(page->lines, "equation\t%s\t%s\t%s\t%s\n", label != NULL ? label : "", left, right,
            latex_of_equation(page->model, left, right));
    return;
  }
  xmlTextWriterStartElement(page->writer, BAD_CAST "div");
  write_attribute(page->writer, "class", "equation");
  if (label != NULL) page_element(page, "span", label);
  write_text(page, NULL, left, right);
  xmlTextWriterEndElement(page->writer);
}

void page_equation(const struct Page *page, const char *left, Node right) {
  write_equation(page, NULL, left, right_side(page, left, right));
}

void page_labelled_equation(const struct Page *page, const char *label, Node left, Node right) {
  write_equation(page, label, display_text(page->display, left), display_text(page->display, right));
}

void page_fold(const struct Page *page, const char *summary) {
  if (page->lines != NULL) return;
  xmlTextWriterStartElement(page->writer, BAD_CAST "details");
  page_element(page, "summary", summary);
}

void page_end_fold(const struct Page *page) {
  if (page->lines == NULL) xmlTextWriterEndElement(page->writer);
}

void page_step(const struct Page *page, const char *heading) {
  if (page->lines != NULL) fprintf(page->lines, "step\t%s\n", heading);
  else page_element(page, "h3", heading);
}

void page_step_texts(const struct Page *page, const char *left, const char *right) {
  bool is_short = strlen(left) + strlen(right) <= STEP_LENGTH_LIMIT;
  if (page->lines != NULL)
    fprintf(page->lines, "line\t%s\t%s\t%s\n", left, is_short ? right : "...",
            is_short ? latex_of_equation(page->model, left, right) : "");
  else if (is_short) write_text(page, "step", left, right);
  else page_element(page, "p", format_text("%s is too long to be shown.", left));
}

void page_step_equation(const struct Page *page, const char *left, Node right) {
  page_step_texts(page, left, right_side(page, left, right));
}

static bool has_name(const struct VariableList *list, const char *name) {
  bool found = false;
  for (size_t i = 0; i < list->count; i++) found |= strcmp(list->items[i].name, name) == 0;
  return found;
}

const char *page_symbol(const struct Model *model, const char *symbol, const char *word) {
  const struct VariableList *lists[] = {&model->parameters,  &model->calculated, &model->inputs,
                                        &model->coordinates, &model->velocities, &model->states,
                                        &model->definitions, &model->outputs};
  bool is_name = false;
  for (size_t i = 0; i < 8; i++) is_name |= has_name(lists[i], symbol);
  return is_name ? word : symbol;
}

void page_rest(const struct Page *page, size_t count, size_t shown, const char *objects) {
  if (count == shown) return;
  char *text = format_text("%zu further %s are not shown.", count - shown, objects);
  page_paragraph(page, text);
}
