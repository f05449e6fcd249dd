/*
 * Named expressions: the text of each <define>, the value of each calculated <parameter> and each component of a particle
 * or body, which may use each other in any order. All names are collected first; then each expression is read after those that it needs.
 */
#ifndef DEFINITIONS_H
#define DEFINITIONS_H

#include "read/elements/named_expressions.h"

struct Definitions *definitions_create(void);
void definitions_free(struct Definitions *definitions);

/* The index of a <for> has a new value until the next call of definitions_leave(). */
void definitions_enter(struct Definitions *definitions, const char *index, double value);
void definitions_leave(struct Definitions *definitions);

/* Collects an expression under its name, which is taken over, as it is for the present indices. */
void definitions_add(struct Definitions *definitions, char *name, const struct NamedExpression *expression);

/* Reads all expressions and makes their names known; names those that need each other in a circle. */
void definitions_resolve(struct Definitions *definitions, struct Reader *reader);

/* Whether the name is that of an expression which has not been read yet; the present one then waits for it. */
bool definitions_wait_for(struct Definitions *definitions, const char *name);

/* Whether an expression of this name was collected; false without definitions. */
bool definitions_contain(const struct Definitions *definitions, const char *name);

/* Whether the present expression waits, so that its value means nothing and its mistakes are told when it is read again. */
bool definitions_are_waiting(const struct Definitions *definitions);

#endif
