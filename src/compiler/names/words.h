/* Reserved words of the language. */
#pragma once

#include <stdio.h>

#include "names/scope.h"

/* Functions that are not operations of the expression graph, ending with NULL. */
extern const char *const special_functions[];

/* Functions whose names variables may have too, up to NULL. Before a parenthesis the name is the function. */
extern const char *const free_functions[];

/* Returns the operation of this name in the language; OPERATION_COUNT for none. */
enum Operation find_function(const char *name);

/* True if the name is that of a function and reserved for it. */
bool is_function_name(const char *name);

/* True if the name is reserved: a function, pi, time, or a result of all systems. */
bool is_word(const char *name);

/* Defines all reserved words but time. */
void define_language(struct Scope *scope);

/* Prints a line for each word: "function NAME" or "name NAME". */
void words_print(FILE *file);
