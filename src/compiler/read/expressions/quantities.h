/*
 * Arithmetic with quantities: operations on nodes and dimensions at once. What has no finite value or mixes units is
 * reported, and parser->failed is then set.
 */
#ifndef QUANTITIES_H
#define QUANTITIES_H

#include "read/expressions/parser_state.h"

struct Quantity quantity_add(struct Parser *parser, struct Quantity a, struct Quantity b);
struct Quantity quantity_subtract(struct Parser *parser, struct Quantity a, struct Quantity b);
struct Quantity quantity_multiply(struct Parser *parser, struct Quantity a, struct Quantity b);
struct Quantity quantity_divide(struct Parser *parser, struct Quantity a, struct Quantity b);
struct Quantity quantity_power(struct Parser *parser, struct Quantity base, struct Quantity exponent);

/* A function of the language other than a power; b is ignored for one argument. */
struct Quantity quantity_function(struct Parser *parser, enum Operation operation, struct Quantity a,
                                  struct Quantity b);

#endif
