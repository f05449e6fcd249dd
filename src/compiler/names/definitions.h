/*
 * Named expressions: the text of each <define> and <output>, the value of each calculated <parameter>, and each component of a
 * particle or body. They may use each other in any order.
 *
 * All names are collected first. Then the expressions are parsed in topological order by a depth-first search with an
 * explicit stack. An expression that meets unparsed names pushes them and is parsed again after them, so that most are
 * parsed at most twice. An expression that waits for an ACTIVE one closes a cycle, which is reported.
 *
 * The text of an <output> is such an expression, too, but is parsed only where others use it; see definitions_parse_now().
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include <libxml/tree.h>

struct Scope;
struct Source;
struct Override;

/* An expression and the element that it belongs to. */
struct NamedExpression {
  xmlNodePtr node;
  const char *attribute;            /* contains the expression; NULL for the element's text */
  struct Source *source;            /* of the element */
  const struct Override *overrides; /* the override by an <include> that contains the expression; NULL for none */
};

/* A <for> with one value of its index. `outer` leads to the enclosing ones. */
struct Loop {
  char *index;
  double value;
  xmlNodePtr node;
  struct Source *source;    /* of the <for> */
  const struct Loop *outer; /* next enclosing one; NULL for none */
};

/*
 * UNREAD: not yet parsed. ACTIVE: waits for other expressions. READ: parsed, and its value is known. TAKEN: READ, and
 * its element has been read.
 */
enum DefinitionState { UNREAD, ACTIVE, READ, TAKEN };

/* A named expression, with the loops around it and its state. */
struct Definition {
  char *name;
  struct NamedExpression expression;
  const struct Loop *loop;
  enum DefinitionState state;
};

/* All named expressions of a system. Names are unique. */
struct Definitions {
  struct Definition *items;
  size_t count;
  struct Names *numbers;      /* name -> size_t, an index into items */
  const struct Loop *present; /* innermost <for> during collection; NULL for none */
  size_t *stack;              /* indices of items to be parsed, the current one on top */
  size_t stack_count, waiting;
  void (*parse)(void *reader, size_t number); /* parses an item, and those that it needs */
  void *reader;
};

/* Returns an empty collection. */
struct Definitions *definitions_create(void);

/* Enter a <for> with a value of its index, and leave it again. */
void definitions_enter(struct Definitions *definitions, struct Loop loop);
void definitions_leave(struct Definitions *definitions);

/* Define the indices of all loops as numbers, and remove them again, except names with another meaning. */
void bind_indices(struct Scope *scope, const struct Loop *loop);
void unbind_indices(struct Scope *scope, const struct Loop *loop);

/* Collects an expression under its name, with the present indices. */
void definitions_add(struct Definitions *definitions, char *name, const struct NamedExpression *expression);

/* Schedules an item to be parsed before those on the stack. */
void definitions_push(struct Definitions *definitions, size_t number);

/* True if the name is that of an expression that has not been parsed. The current expression then waits for it. */
bool definitions_wait_for(struct Definitions *definitions, const char *name);

/* Parses an expression outside of the stack, as an <output> that a force uses. False if none of this name is unparsed. */
bool definitions_parse_now(struct Definitions *definitions, const char *name);

/* True if the expression of this element, under this name, has been parsed; false if it is asked for once more. */
bool definitions_take(struct Definitions *definitions, const char *name, const xmlNode *node);

/* True if an expression of this name was collected; false if there are no definitions. */
bool definitions_contain(const struct Definitions *definitions, const char *name);

/* True if the current expression waits: its value is meaningless, and it will be parsed again. */
bool definitions_are_waiting(const struct Definitions *definitions);
