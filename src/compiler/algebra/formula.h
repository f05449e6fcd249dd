/* Expressions as infix text in the language of system.xml. */
#pragma once

#include <stdio.h>

#include "algebra/graph.h"

/* Returns the text; a very long one is cut off with "...". */
char *expression_text(const struct Graph *graph, Node node);

/* Names that replace expressions: of[node] is the name of a node below count, or NULL. */
struct NodeNames {
  const char **of;
  size_t count;
  Node *named; /* the nodes that have a name */
  size_t named_count;
};

/* Returns the text with these names for all subexpressions. */
char *expression_text_with_names(const struct Graph *graph, Node node, const struct NodeNames *names);

/* if(guard_condition > 0, positive, other) */
struct Conditional {
  Node guard_condition, positive, other;
};

/* True for a guard, and for a sum of two guards with opposite conditions. */
bool choice_of(const struct Graph *graph, Node node, struct Conditional *choice);

/* Bytes for a number's text; 17 digits with sign, point and exponent take 25. */
enum { NUMBER_LENGTH = 40 };

/* Writes the shortest decimal form, of at least 15 digits' precision, that reads back as the same number. */
void number_text(double value, char text[NUMBER_LENGTH]);
void print_number(FILE *file, double value);
