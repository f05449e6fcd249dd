/* The page that is being written, and what its sections are made of. */
#ifndef PAGE_H
#define PAGE_H

#include <libxml/xmlwriter.h>

#include "drawing/shapes.h"
#include "interface/summary.h"
#include "program/program.h"

struct Page {
  xmlTextWriterPtr writer;
  const struct Program *program;
  const struct Model *model;
  const struct Equations *equations;
  const struct Interface *interface;
  const struct Summary *summary;
  const struct Drawing *drawing;
  const char **headings; /* of the sections so far, for the contents */
  size_t heading_count;
};

/* The heading of a section, which the contents will name. */
void page_heading(struct Page *page, const char *heading);

/* An element with nothing but text in it. */
void page_element(const struct Page *page, const char *name, const char *text);

/* left = expression, typeset, and as text to copy. */
void page_equation(const struct Page *page, const char *left, Node right);

/* Says how many of the things of a kind the page leaves out. */
void page_rest(const struct Page *page, size_t count, size_t shown, const char *things);

#endif
