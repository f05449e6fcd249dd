/* The heads of the functions of the generated code, which both writers write. */
#ifndef FUNCTION_TEXT_H
#define FUNCTION_TEXT_H

#include <stdio.h>

#include "program/program.h"

/* Those of several routines, or of one of many; the others are in routine_facts. */
extern const struct FunctionText start_text, result_text, results_text, result_along_text, series_text,
    output_series_text, limit_text, watched_limit_text;

/* Whether the argument, as declared, is among those of the function. */
bool takes(const struct FunctionText *text, const char *argument);

/* The comment and the head of a function, up to its brace; suffix belongs to the name. */
void write_head(FILE *file, const struct FunctionText *text, const char *suffix, size_t operations);

#endif
