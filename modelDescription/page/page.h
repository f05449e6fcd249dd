/* The page under construction, and the elements of its sections. */
#ifndef PAGE_H
#define PAGE_H

#include <libxml/xmlwriter.h>

#include "drawing/shapes.h"
#include "interface/summary.h"
#include "program/program.h"

/* The page, whose sections are written in order by one writer. */
struct Page {
  xmlTextWriterPtr writer;
  const struct Program *program;
  const struct Model *model;
  const struct Equations *equations;
  const struct Interface *interface;
  const struct Summary *summary;
  const struct Drawing *drawing;
  const char **headings; /* of the sections so far, for the table of contents */
  size_t heading_count;
};

/* Writes a heading, which the table of contents will list. */
void page_heading(struct Page *page, const char *heading);

/* Writes an element that contains only text. */
void page_element(const struct Page *page, const char *name, const char *text);

/* Writes left = right, typeset and as text to copy. */
void page_equation(const struct Page *page, const char *left, Node right);

/* Writes how many objects of a kind the page omits; nothing if none. */
void page_rest(const struct Page *page, size_t count, size_t shown, const char *things);

#endif
