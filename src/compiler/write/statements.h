/* Writes functions as C functions, a statement for each instruction. */
#pragma once

#include "write/function_text.h"

/* Declares names for the parts of the point and the direction that the function reads. */
void statements_declare_point(FILE *file, const struct Program *program, const struct IrFunction *ir);

/* Writes a function of one instruction list; suffix extends its name. */
void statements_function(FILE *file, const struct Program *program, enum FunctionName name, const char *suffix,
                         const struct IrFunction *ir);

/* Writes a function with a status, in parts if it is long. Returns the length of point->work that the parts share. */
size_t statements_in_parts(FILE *file, const struct Program *program, enum FunctionName name);

/* Writes result() and result_along(), which select a function for each result. */
void statements_results(FILE *file, const struct Program *program);

/* Writes start(), series() and limit(). */
void statements_series(FILE *file, const struct Program *program);

/* Writes output_series(). */
void statements_output_series(FILE *file, const struct Program *program);

/* Writes watched_limit(). */
void statements_watched_limit(FILE *file, const struct Program *program);
