/* Numbers and strings as C constants. */
#pragma once

#include <stdio.h>

/* A constant of type double. */
void write_c_number(FILE *file, double value);

void write_c_string(FILE *file, const char *text);

/* The definition of a static array of whole numbers; of one element where there are none. */
void write_sizes(FILE *file, const char *type, const char *name, const size_t *sizes, size_t count);

/* The same of integers from 0 on. */
void write_whole_numbers(FILE *file, const char *name, const int *numbers, size_t count);
