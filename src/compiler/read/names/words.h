/* The words of the language, which systems cannot use as names. */
#pragma once

#include <stdio.h>

#include "read/names/scope.h"

/* The functions of the language that are no operations of the graph, up to NULL. */
extern const char *const special_functions[];

/* Those of them whose names a system may give to others: a name with a parenthesis is the function. */
extern const char *const free_functions[];

/* The operation that the language calls by this name, OPERATION_COUNT for none. */
enum Operation find_function(const char *name);

/* Whether it is one of either, whose name no other can have. */
bool is_function_name(const char *name);

/* Whether nothing in a system can have this name: a function, pi, time, or a result that systems have. */
bool is_word(const char *name);

/* Makes all of them but time known. */
void define_language(struct Scope *scope);

/* A line for each of them: "function NAME" or "name NAME". */
void words_print(FILE *file);
