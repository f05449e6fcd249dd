/*
 * The page under construction, and the elements of its sections: as HTML, or as lines of text with tabs, which the
 * command `lagrange-fmu show` reads.
 */
#ifndef PAGE_H
#define PAGE_H

#include <stdio.h>

#include <libxml/xmlwriter.h>

#include "display/display.h"
#include "interface/summary.h"
#include "program/program.h"

/* The page, whose sections are written in order by one writer. */
struct Page {
  xmlTextWriterPtr writer; /* NULL for lines */
  FILE *lines;             /* NULL for HTML */
  const struct Program *program;
  const struct Model *model;
  const struct Equations *equations;
  const struct Interface *interface;
  const struct Summary *summary;
  struct Display *display;
  const char **headings; /* of the sections so far, for the table of contents */
  size_t heading_count;
};

/* Writes a heading, which the table of contents will list. */
void page_heading(struct Page *page, const char *heading);

/* Writes an element that contains only text. */
void page_element(const struct Page *page, const char *name, const char *text);

/* Writes a paragraph. */
void page_paragraph(const struct Page *page, const char *text);

/* Writes left = right as text, which the page's script typesets. */
void page_equation(const struct Page *page, const char *left, Node right);

/* Writes an equation of two sides with a label before it. */
void page_labelled_equation(const struct Page *page, const char *label, Node left, Node right);

/* Begin and end a part that is folded until a reader opens it. */
void page_fold(const struct Page *page, const char *summary);
void page_end_fold(const struct Page *page);

/* Writes the heading of a step of a derivation. */
void page_step(const struct Page *page, const char *heading);

/* Writes an equation of a derivation, of which the script keeps no text. */
void page_step_equation(const struct Page *page, const char *left, Node right);
void page_step_texts(const struct Page *page, const char *left, const char *right);

/* Returns the symbol of a quantity, such as L, or the word if a name of the system is this symbol. */
const char *page_symbol(const struct Model *model, const char *symbol, const char *word);

/* Writes how many objects of a kind the page omits; nothing if none. */
void page_rest(const struct Page *page, size_t count, size_t shown, const char *objects);

#endif
