/* Writes numbers, strings and arrays as C constants. */
#pragma once

#include <stdio.h>

/* Writes a number with as many digits as distinguish it from all others. */
void write_c_number(FILE *file, double value);

/* Writes a string literal. */
void write_c_string(FILE *file, const char *text);

/* Writes the definition of a static array of whole numbers; an empty one gets an element 0, as C requires. */
void write_sizes(FILE *file, const char *type, const char *name, const size_t *sizes, size_t count);

/* Does the same for nonnegative integers. */
void write_whole_numbers(FILE *file, const char *name, const int *numbers, size_t count);
