/* The tables of routines as C, and the functions that have them carried out. */
#pragma once

#include "program/tables/encoding.h"
#include "write/function_text.h"

/* The numbers, functions and blocks that all tables share. */
void instruction_tables_shared(FILE *file, const struct Encoding *encoding);

/* A function of one routine. */
void instruction_tables_function(FILE *file, const struct Encoding *encoding, enum FunctionName name,
                                 const struct Routine *routine);

/* result() and result_along() */
void instruction_tables_results(FILE *file, const struct Encoding *encoding);

/* start(), series() and limit(). */
void instruction_tables_series(FILE *file, const struct Encoding *encoding);

/* output_series() */
void instruction_tables_output_series(FILE *file, const struct Encoding *encoding);
