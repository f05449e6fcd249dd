/* The math functions that generated code calls. */
#pragma once

typedef double FunctionOfOne(double);
typedef double FunctionOfTwo(double, double);

/* Return a function by its name in C; not NULL for the functions of this arity in algebra/functions.c. */
FunctionOfOne *function_of_one(const char *name);
FunctionOfTwo *function_of_two(const char *name);
