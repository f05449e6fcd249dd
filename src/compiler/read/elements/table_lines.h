/* The lines of numbers in a table's text or file; empty ones are passed over, and what follows # is left out. */
#pragma once

#include "read/context/attributes.h"

struct TableLines {
  struct Reader *reader;
  long line;       /* the present one, for messages */
  bool wrong;      /* after an error, of which there is one a table: no further lines are taken */
  bool is_heading; /* the line may be a heading: the first one of a file */
  void (*take)(struct TableLines *lines, const char *text);
};

/* The file is beside the one that is read; messages name it and its lines. */
void table_lines_of_file(struct TableLines *lines, xmlNodePtr node, const char *name);

/* The text of an element, or a part of it. */
void table_lines_of_text(struct TableLines *lines, xmlNodePtr text);

/* The numbers at the beginning of a line, with blanks, a comma or a semicolon between them; *rest is what follows them. */
double *table_numbers(const char *line, size_t *count, const char **rest);
