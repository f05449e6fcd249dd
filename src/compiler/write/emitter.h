/* What the writers of the generated C file share. */
#ifndef EMITTER_H
#define EMITTER_H

#include <stdio.h>

#include "program/program.h"
#include "write/statements.h"

struct Emitter {
  FILE *file;
  const struct Program *program;
  const struct Equations *equations;
  const struct Graph *graph;
  struct Statements *statements;
  size_t n, states;                       /* coordinates, state variables */
  struct SeriesWriter *series;            /* while series() is written */
  size_t series_rows, output_series_rows; /* of workspace that series() and output_series() need */
  size_t jacobian_elements;               /* in the pattern that is written */
  bool has_series, has_limit;             /* series() and limit() are written */
};

/* A growing list of nodes. */
struct NodeList {
  Node *nodes;
  size_t count;
};

void append_nodes(struct NodeList *list, const Node *nodes, size_t count);

/* array[index] = node, which statements_emit() has computed. */
void emit_assignment(const struct Emitter *emitter, const char *array, size_t index, Node node);

/* The expression of a computed variable. */
Node result_node(const struct Program *program, size_t index);

/* Whether any of the nodes depends on an acceleration. */
bool uses_accelerations(const struct Graph *graph, const Node *nodes, size_t count);

/* Whether the computed variable is an output of the FMU. */
bool result_is_output(const struct Interface *interface, size_t index);

/* Runs a body writer into a buffer, then writes the function with just the declarations that the body uses. */
void emit_function(struct Emitter *emitter, const char *comment, const char *signature,
                   void (*body)(struct Emitter *, size_t), size_t argument);

#endif
