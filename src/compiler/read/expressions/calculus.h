/* Partial derivatives diff(...) and integrals integral(...). */
#pragma once

#include "read/expressions/cursor.h"

/* Parses diff(expression, name) after its opening parenthesis: the partial derivative, other names constant. */
struct Quantity parse_partial_derivative(struct Parser *parser);

/* Parses integral(name, from, to, expression [, nodes]) after its opening parenthesis. */
struct Quantity parse_integral(struct Parser *parser);
