/* What the files that read expressions share. */
#ifndef PARSER_STATE_H
#define PARSER_STATE_H

#include "read/names/definitions.h"
#include "read/expressions/parser.h"

struct Parser {
  struct Scope *scope;
  struct Graph *graph;
  struct Place place;
  const char *text, *next;
  const char *counted; /* the line breaks before are newlines: counting goes on from there */
  long newlines;
  int nesting;
  long repetitions; /* bodies of sum(...) parsed so far */
  bool failed;
};

/* An expression from the reading position on, as far as it goes. */
struct Quantity parse_sum(struct Parser *parser);

void skip_space(struct Parser *parser);

/* Whether the character comes next, which is then passed. */
bool accept_character(struct Parser *parser, char c);

/* The same of one that must come; context completes "expected '('". */
void expect_character(struct Parser *parser, char c, const char *context);

/* The line of the reading position. */
long current_line(struct Parser *parser);

/* Reports the first error of an expression; later ones would only follow from it. */
#define FAIL(parser, ...)                                                                                              \
  do {                                                                                                                 \
    if (!(parser)->failed && !definitions_are_waiting((parser)->scope->definitions))                                   \
      report_error((parser)->scope->diagnostics, current_line(parser), __VA_ARGS__);                                   \
    (parser)->failed = true;                                                                                           \
  } while (0)

#endif
