/* Lines of numbers in the text or file of a table. Empty lines are skipped; # begins a comment. */
#pragma once

#include "read/context/attributes.h"

/* A reader of lines. `take` gets each line that is not empty, without its comment. */
struct TableLines {
  struct Reader *reader;
  long line;       /* current line, for messages */
  bool wrong;      /* after an error: no further lines are read, so that a table has one error */
  bool is_heading; /* the line may be a heading, as the first one of a file */
  void (*take)(struct TableLines *lines, const char *text);
};

/* Calls `take` for each line of a file, which is relative to the current file. Messages name the file and its lines. */
void table_lines_of_file(struct TableLines *lines, xmlNodePtr node, const char *name);

/* Calls `take` for each line of a text node. */
void table_lines_of_text(struct TableLines *lines, xmlNodePtr text);

/*
 * Returns the numbers at the beginning of a line, separated by blanks, a comma or a semicolon, and sets their count.
 * *rest: the text after them.
 */
double *table_numbers(const char *line, size_t *count, const char **rest);
