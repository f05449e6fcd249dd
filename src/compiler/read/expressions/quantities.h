/*
 * Arithmetic of quantities: builds the expression and checks the units. Results that are not finite and units that do
 * not agree are reported, and parser->failed is set.
 */
#pragma once

#include "read/expressions/cursor.h"
#include "read/tables/table.h"

struct Quantity quantity_add(struct Parser *parser, struct Quantity a, struct Quantity b);
struct Quantity quantity_subtract(struct Parser *parser, struct Quantity a, struct Quantity b);
struct Quantity quantity_multiply(struct Parser *parser, struct Quantity a, struct Quantity b);
struct Quantity quantity_divide(struct Parser *parser, struct Quantity a, struct Quantity b);
struct Quantity quantity_power(struct Parser *parser, struct Quantity base, struct Quantity exponent);

/* Returns floor, ceil, round or mod, by name; b is used by mod only. */
struct Quantity quantity_rounded(struct Parser *parser, const char *name, struct Quantity a, struct Quantity b);

/* Returns uniform or gauss, by name, of a seed and an index, rounded to an integer if it varies continuously. */
struct Quantity quantity_random(struct Parser *parser, const char *name, struct Quantity seed, struct Quantity number);

/* Returns a function of the expression graph other than a power; b is ignored for functions of one argument. */
struct Quantity quantity_function(struct Parser *parser, enum Operation operation, struct Quantity a,
                                  struct Quantity b);

/* Returns the value of a table of this name at its one or two arguments. */
struct Quantity quantity_of_table(struct Parser *parser, const struct Table *table, const char *name,
                                  const struct Quantity arguments[2]);
