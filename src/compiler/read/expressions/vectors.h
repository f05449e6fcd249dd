/* Functions of vectors: points, their velocities, axes of frames, and what is made of them, along the base's axes. */
#pragma once

#include "read/expressions/cursor.h"

/* Whether the name is cross, distance, dot or norm. */
bool is_function_of_vectors(const char *name);

/* Parses its arguments and the parenthesis that closes them. */
struct Quantity parse_function_of_vectors(struct Parser *parser, const char *name);
