/* Routines as functions of C statements, one for each instruction. */
#pragma once

#include "write/function_text.h"

/* Names for what the routine reads of the point and the direction. */
void statements_declare_point(FILE *file, const struct Program *program, const struct Routine *routine);

/* A function of one routine; suffix belongs to its name. */
void statements_function(FILE *file, const struct Program *program, enum FunctionName name, const char *suffix,
                         const struct Routine *routine);

/* A function of a status, in parts where it is long. Returns how many numbers of point->work they share. */
size_t statements_in_parts(FILE *file, const struct Program *program, enum FunctionName name);

/* result() and result_along(), which choose among a function for each result. */
void statements_results(FILE *file, const struct Program *program);

/* start(), series() and limit(). */
void statements_series(FILE *file, const struct Program *program);

/* output_series() */
void statements_output_series(FILE *file, const struct Program *program);

/* watched_limit() */
void statements_watched_limit(FILE *file, const struct Program *program);
