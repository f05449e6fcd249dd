/* The words of the language, which systems cannot use as names. */
#ifndef WORDS_H
#define WORDS_H

#include "read/names/scope.h"

/* The functions of the language that are no operations of the graph, up to NULL. */
extern const char *const special_functions[];

/* The operation that the language calls by this name, OPERATION_COUNT for none. */
enum Operation find_function(const char *name);

/* Whether it is one of either. */
bool is_function_name(const char *name);

/* Makes the names of the language itself known: pi and the functions. */
void define_language(struct Scope *scope);

/* Keeps the names of the results that every system has. */
void reserve_result_names(struct Scope *scope);

#endif
