/* Derivatives by a name, and integrals. */
#pragma once

#include "read/expressions/cursor.h"

/* diff(expression, name), behind its first parenthesis: the derivative with all other names held constant. */
struct Quantity parse_partial_derivative(struct Parser *parser);

/* integral(name, from, to, expression) or integral(name, from, to, expression, nodes), behind its first parenthesis. */
struct Quantity parse_integral(struct Parser *parser);
