/* The state of the expression parser: reading position, local names and error flag. */
#pragma once

#include "names/definitions.h"
#include "names/scope.h"

/* The context of an expression: its line and subject for messages, and the symbols that it may depend on. */
struct Location {
  long line;
  const char *what;      /* such as "the potential" */
  unsigned kinds;        /* bit k: may depend on symbols of kind k */
  int input_derivatives; /* time derivatives that each input in the expression must have */
};

/* A name that is valid in a part of an expression: an index of a sum, a variable of an integral, an argument. */
struct Local {
  const char *name;
  struct Quantity value;
  struct Local *outer; /* the enclosing one; NULL for none */
};

struct NamedFunction;

/* A parser of one expression. Parsing functions advance `next`. */
struct Parser {
  struct Scope *scope;
  struct Graph *graph;
  struct Location location;
  const char *text, *next;
  const char *counted; /* end of the text whose line breaks are counted in `newlines` */
  long newlines;
  int nesting;
  long repetitions; /* bodies of sum(...) parsed so far */
  struct Local *locals;
  const struct NamedFunction *function; /* whose expression is parsed; NULL for none */
  const struct Parser *caller;          /* the parser of the expression that calls the function */
  const char *use;                      /* the outermost call of the function, for messages */
  bool failed;
};

/* Moves the reading position past white space. */
void skip_space(struct Parser *parser);

/* Skips white space, and the character c if it follows. Returns false if another character follows. */
bool accept_character(struct Parser *parser, char c);

/* Skips white space and the character c, or reports an error. context completes "expected '('". */
void expect_character(struct Parser *parser, char c, const char *context);

/* Returns the token at the reading position in quotes, or "the end", for messages. The text may be in the buffer. */
const char *found(const struct Parser *parser, char buffer[32]);

/* Returns the value of a local name, else of a name in the scope; NULL if it is unknown. */
const struct Quantity *find_quantity(const struct Parser *parser, const char *name);

/* Returns the line of the reading position. */
long current_line(struct Parser *parser);

/*
 * Reports the first error of an expression and sets parser->failed. Later errors are not reported, as the first may
 * cause them. An expression that waits for a definition reports nothing: it will be parsed again.
 */
#define FAIL(parser, ...)                                                                                              \
  do {                                                                                                                 \
    if (!(parser)->failed && !definitions_are_waiting((parser)->scope->definitions))                                   \
      report_error((parser)->scope->diagnostics, current_line(parser), __VA_ARGS__);                                   \
    (parser)->failed = true;                                                                                           \
  } while (0)
