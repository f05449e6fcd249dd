/*
 * Named expressions: the text of each <define>, the value of each calculated <parameter> and each component of a particle
 * or body, which may use each other in any order. All names are collected first; then each expression is read after those that it needs.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include <libxml/tree.h>

struct Scope;
struct Source;
struct Given;

/* An expression and the element whose name it has. */
struct NamedExpression {
  xmlNodePtr node;
  const char *attribute;     /* that holds the expression; NULL for the text */
  struct Source *source;     /* in which the element stands */
  const struct Given *given; /* where an <include> gives the expression; else NULL */
};

/* A <for> with a value of its index, and those further out. */
struct Loop {
  char *index;
  double value;
  xmlNodePtr node;
  struct Source *source;    /* in which it stands */
  const struct Loop *outer; /* the next one around it */
};

/* ACTIVE: it has been found to need others, which are read now. */
enum DefinitionState { UNREAD, ACTIVE, READ };

struct Definition {
  char *name;
  struct NamedExpression expression;
  const struct Loop *loop;
  enum DefinitionState state;
};

struct Definitions {
  struct Definition *items;
  size_t count;
  struct Names *numbers;      /* name -> size_t, its place among the items */
  const struct Loop *present; /* around what is collected now; NULL for none */
  size_t *stack;              /* those to be read, the present one on top */
  size_t stack_count, waiting;
};

struct Definitions *definitions_create(void);

/* The index of a <for> has a new value until the next call of definitions_leave(). */
void definitions_enter(struct Definitions *definitions, struct Loop loop);
void definitions_leave(struct Definitions *definitions);

/* Gives all indices their values, and takes them back; none that has another meaning. */
void bind_indices(struct Scope *scope, const struct Loop *loop);
void unbind_indices(struct Scope *scope, const struct Loop *loop);

/* Collects an expression under its name, as it is for the present indices. */
void definitions_add(struct Definitions *definitions, char *name, const struct NamedExpression *expression);

/* That of this number is to be read before those on the stack. */
void definitions_push(struct Definitions *definitions, size_t number);

/* Whether the name is that of an expression which has not been read yet; the present one then waits for it. */
bool definitions_wait_for(struct Definitions *definitions, const char *name);

/* Whether an expression of this name was collected; false without definitions. */
bool definitions_contain(const struct Definitions *definitions, const char *name);

/* Whether the present expression waits, so that its value means nothing and its mistakes are told when it is read again. */
bool definitions_are_waiting(const struct Definitions *definitions);
