/* Straight-line C for expressions: each shared operation is computed once, parameters' share of it beforehand. */
#ifndef STATEMENTS_H
#define STATEMENTS_H

#include <stdio.h>

#include "graph.h"

struct Statements {
  const struct Graph *graph;
  FILE *file;
  size_t *slot;   /* per node: 1 + place in prepared[], 0 for none */
  Node *prepared; /* the nodes that prepare() computes, ascending */
  size_t prepared_count;
  bool preparing; /* inside prepare(): parameters' expressions are computed, not fetched */
  size_t *number; /* per node: its local variable's number in the current function, 0 for none yet */
  size_t local_count;
  size_t operation_count; /* emitted in the current function */
};

struct Statements *statements_create(const struct Graph *graph);
void statements_free(struct Statements *statements);

/* Announces targets of the code to come; decides which expressions of parameters become prepared. */
void statements_announce(struct Statements *statements, const Node *targets, size_t count);

/* Gives each announced expression of parameters its place in prepared[]. */
void statements_settle(struct Statements *statements);

/* Begins a function: no local variables yet, output to file. */
void statements_begin(struct Statements *statements, FILE *file);

/* Emits what the targets need and is not computed yet, one `const double` a node. */
void statements_emit(struct Statements *statements, const Node *targets, size_t count);

/* Writes an operand: a local variable, a symbol, a prepared value or a number. */
void statements_operand(const struct Statements *statements, Node node);

/* Writes a number as a C constant of type double. */
void write_c_number(FILE *file, double value);

#endif
