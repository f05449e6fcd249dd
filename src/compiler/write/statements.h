/* Straight-line C for expressions: each shared operation is computed once, parameters' share of it beforehand. */
#ifndef STATEMENTS_H
#define STATEMENTS_H

#include <stdio.h>

#include "algebra/graph.h"

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

/* How a node is written: an operator between operands, a function of them, ... */
enum Form { FORM_SUM, FORM_DIFFERENCE, FORM_PRODUCT, FORM_QUOTIENT, FORM_NEGATION, FORM_POWER, FORM_FUNCTION };

struct Expression {
  enum Form form;
  Node left, right;
  int arity;
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

/* Whether the node is a leaf, or fetched instead of computed in the current function. */
bool is_fetched(const struct Statements *statements, Node node);

/* How often the targets need each node; free with free(). */
size_t *count_uses(const struct Statements *statements, const Node *targets, size_t count);

/* How to write a node, with a + (-b) turned to a - b and a * (1 / b) to a / b, where uses tells of no other need. */
struct Expression expression_of(const struct Statements *statements, Node node, const size_t *uses);

/* Writes an operand: a local variable, a symbol, a prepared value or a number. */
void statements_operand(const struct Statements *statements, Node node);

/* Writes a number as a C constant of type double. */
void write_c_number(FILE *file, double value);

#endif
