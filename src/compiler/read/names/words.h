/* The words of the language, which systems cannot use as names. */
#pragma once

#include <stdio.h>

#include "read/names/scope.h"

/* The functions of the language that are no operations of the graph, up to NULL. */
extern const char *const special_functions[];

/* The operation that the language calls by this name, OPERATION_COUNT for none. */
enum Operation find_function(const char *name);

/* Whether it is one of either. */
bool is_function_name(const char *name);

/* Whether nothing in a system can have this name: a function, pi, time, or a result that systems have. */
bool is_word(const char *name);

/* Makes all of them but time known. */
void define_language(struct Scope *scope);

/* A line for each of them: "function NAME" or "name NAME". */
void words_print(FILE *file);
