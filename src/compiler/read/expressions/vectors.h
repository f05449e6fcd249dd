/*
 * Functions of vectors, which are points, their velocities, axes of frames, angular velocities and combinations of
 * these. All components are along the base's axes.
 */
#pragma once

#include "read/expressions/cursor.h"

/* True if the name is cross, distance, dot or norm. */
bool is_function_of_vectors(const char *name);

/* Parses the arguments of such a function and its closing parenthesis. Reports cross, which is no scalar. */
struct Quantity parse_function_of_vectors(struct Parser *parser, const char *name);
