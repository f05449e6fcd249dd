#include "page.h"

#include <string.h>

#include "algebra/formula.h"
#include "base/memory.h"
#include "mathml.h"
#include "xml_output.h"

/* Characters above which an equation of a derivation is left out. */
enum { STEP_LENGTH_LIMIT = 600 };

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
  return display_text(page->display, right);
}

/* Returns the name of the constraint of which a word is the force, NAME.force; NULL for other words. */
static const char *constraint_of_force(const struct Page *page, const char *word, size_t length) {
  static const char force[] = ".force";
  const size_t end = sizeof force - 1;
  const struct VariableList *constraints = &page->model->constraints;
  if (length <= end || memcmp(word + length - end, force, end) != 0) return NULL;
  for (size_t i = 0; i < constraints->count; i++) {
    const struct Variable *constraint = &constraints->items[i];
    bool is_equal = strlen(constraint->name) == length - end && memcmp(constraint->name, word, length - end) == 0;
    if (is_equal && constraint->force_name == NULL) return constraint->name;
  }
  return NULL;
}

char *page_with_multipliers(const struct Page *page, const char *text) {
  struct TextStream result;
  FILE *file = open_text(&result);
  for (size_t length; *text != '\0'; text += length) {
    length = strcspn(text, " (),*/^");
    const char *name = constraint_of_force(page, text, length);
    if (name != NULL) fprintf(file, "%s.lambda", name);
    else fprintf(file, "%.*s", (int)length, text);
    if (text[length] != '\0') fputc(text[length++], file);
  }
  return close_text(&result);
}

/* Returns an equation as MathML; NULL if it is too long. */
static char *typeset_equation(const struct Page *page, const char *text) {
  return mathml_of_equation(page_with_multipliers(page, text));
}

/* Writes an equation that is given as MathML. */
static void write_formula(const struct Page *page, const char *math) {
  xmlTextWriterStartElement(page->writer, BAD_CAST "p");
  write_attribute(page->writer, "class", "formula");
  xmlTextWriterWriteRaw(page->writer, BAD_CAST math);
  xmlTextWriterEndElement(page->writer);
}

static void write_equation(const struct Page *page, const char *label, const char *left, const char *right) {
  if (page->lines != NULL) {
    fprintf(page->lines, "equation\t%s\t%s\t%s\n", label != NULL ? label : "", left, right);
    return;
  }
  char *text = format_text("%s = %s", left, right);
  char *math = typeset_equation(page, text);
  xmlTextWriterStartElement(page->writer, BAD_CAST "div");
  write_attribute(page->writer, "class", math != NULL ? "equation" : "long equation");
  if (label != NULL) page_element(page, "span", label);
  if (math != NULL) {
    write_formula(page, math);
    write_text(page, "as text", text);
  } else {
    char *summary = strlen(left) > 40 ? copy_text("a long equation; click to see it")
                                      : format_text("%s = ..., a long equation; click to see it", left);
    write_text(page, summary, text);
  }
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
  char *text = format_text("%s = %s", left, right);
  bool is_short = strlen(text) <= STEP_LENGTH_LIMIT;
  if (page->lines != NULL) {
    fprintf(page->lines, "line\t%s\t%s\n", left, is_short ? right : "...");
    return;
  }
  char *math = is_short ? typeset_equation(page, text) : NULL;
  if (math != NULL) write_formula(page, math);
  else page_element(page, "p", format_text("%s is too long to be shown.", left));
}

void page_step_equation(const struct Page *page, const char *left, Node right) {
  page_step_texts(page, left, right_side(page, left, right));
}

void page_rest(const struct Page *page, size_t count, size_t shown, const char *things) {
  if (count == shown) return;
  char *text = format_text("%zu further %s are not shown.", count - shown, things);
  page_paragraph(page, text);
}
