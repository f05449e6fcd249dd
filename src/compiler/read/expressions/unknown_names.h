/* Messages about names and functions that an expression cannot use. */
#ifndef UNKNOWN_NAMES_H
#define UNKNOWN_NAMES_H

#include "read/expressions/parser_state.h"

/* The functions of the language that are no operations of the graph, up to NULL. */
extern const char *const special_functions[];

/* The operation that the language calls by this name, OPERATION_COUNT for none. */
enum Operation find_function(const char *name);

void report_unknown_name(struct Parser *parser, const char *name);
void report_unknown_function(struct Parser *parser, const char *name);

/* A word of the language that has no value: a function without its argument, or a result. */
void report_reserved(struct Parser *parser, const char *name);

#endif
