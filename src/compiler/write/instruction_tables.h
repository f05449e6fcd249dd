/* Writes instruction tables as C arrays, and functions that run the interpreter on them. */
#pragma once

#include "program/tables/encoding.h"
#include "write/function_text.h"

/* Writes the constants, functions and blocks that all tables share. */
void instruction_tables_shared(FILE *file, const struct Encoding *encoding);

/* Writes a function of one instruction list. */
void instruction_tables_function(FILE *file, const struct Encoding *encoding, enum FunctionName name,
                                 const struct IrFunction *ir);

/* Writes two functions that begin with the same instructions; the second one may be missing, or the first one again. */
void instruction_tables_pair(FILE *file, const struct Encoding *encoding, enum FunctionName first,
                             enum FunctionName second);

/* Writes result() and result_along(). */
void instruction_tables_results(FILE *file, const struct Encoding *encoding);

/* Writes start(), series() and limit(). */
void instruction_tables_series(FILE *file, const struct Encoding *encoding);

/* Writes output_series(). */
void instruction_tables_output_series(FILE *file, const struct Encoding *encoding);
