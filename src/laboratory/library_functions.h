/* The functions of C's math library that generated code calls. */
#pragma once

typedef double FunctionOfOne(double);
typedef double FunctionOfTwo(double, double);

/* By the name in C; never NULL for functions of these many operands that algebra/functions.h names. */
FunctionOfOne *function_of_one(const char *name);
FunctionOfTwo *function_of_two(const char *name);
