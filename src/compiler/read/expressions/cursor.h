/* The reading position in the text of an expression. */
#pragma once

#include "read/names/definitions.h"
#include "read/names/scope.h"

/* Where an expression stands, for messages, and what it may depend on. */
struct Place {
  long line;
  const char *what;      /* such as "the potential" */
  unsigned kinds;        /* bit k: may depend on symbols of kind k */
  int input_derivatives; /* how many time derivatives inputs must have there */
};

/* A name that holds in a part of an expression alone: the index of a sum, an argument of a function. */
struct Local {
  const char *name;
  struct Quantity value;
  struct Local *outer; /* the next one around it; NULL for none */
};

struct NamedFunction;

struct Parser {
  struct Scope *scope;
  struct Graph *graph;
  struct Place place;
  const char *text, *next;
  const char *counted; /* the line breaks before are newlines: counting goes on from there */
  long newlines;
  int nesting;
  long repetitions; /* bodies of sum(...) parsed so far */
  struct Local *locals;
  const struct NamedFunction *function; /* whose expression is read; NULL for none */
  const struct Parser *caller;          /* of the function */
  const char *use;                      /* of the function, for messages, without its name */
  bool failed;
};

void skip_space(struct Parser *parser);

/* Whether the character comes next, which is then passed. */
bool accept_character(struct Parser *parser, char c);

/* The same of one that must come; context completes "expected '('". */
void expect_character(struct Parser *parser, char c, const char *context);

/* What stands at the reading position, for messages. */
const char *found(const struct Parser *parser, char buffer[32]);

/* What a name stands for at the reading position; NULL where it is unknown. */
const struct Quantity *find_quantity(const struct Parser *parser, const char *name);

/* The line of the reading position. */
long current_line(struct Parser *parser);

/* Reports the first error of an expression; later ones would only follow from it. */
#define FAIL(parser, ...)                                                                                              \
  do {                                                                                                                 \
    if (!(parser)->failed && !definitions_are_waiting((parser)->scope->definitions))                                   \
      report_error((parser)->scope->diagnostics, current_line(parser), __VA_ARGS__);                                   \
    (parser)->failed = true;                                                                                           \
  } while (0)
