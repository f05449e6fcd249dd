/* Expressions as readable infix text, in the language of system.xml. */
#ifndef PRINT_H
#define PRINT_H

#include <stdio.h>

#include "algebra/graph.h"

/* Writes the expression; very long ones are cut off with "...". */
void print_expression(FILE *file, const struct Graph *graph, Node node);

/* The same as a string, to be freed with free(). */
char *expression_text(const struct Graph *graph, Node node);

enum { NUMBER_LENGTH = 40 };

/* The shortest decimal form that reads back as the same number. */
void number_text(double value, char text[NUMBER_LENGTH]);
void print_number(FILE *file, double value);

#endif
