/*
 * Arithmetic with quantities: operations on nodes and dimensions at once. What has no finite value or mixes units is
 * reported, and parser->failed is then set.
 */
#pragma once

#include "read/expressions/cursor.h"
#include "read/tables/table.h"

struct Quantity quantity_add(struct Parser *parser, struct Quantity a, struct Quantity b);
struct Quantity quantity_subtract(struct Parser *parser, struct Quantity a, struct Quantity b);
struct Quantity quantity_multiply(struct Parser *parser, struct Quantity a, struct Quantity b);
struct Quantity quantity_divide(struct Parser *parser, struct Quantity a, struct Quantity b);
struct Quantity quantity_power(struct Parser *parser, struct Quantity base, struct Quantity exponent);

/* floor, ceil, round or mod; b is ignored for one argument. */
struct Quantity quantity_rounded(struct Parser *parser, const char *name, struct Quantity a, struct Quantity b);

/* uniform or gauss of a seed and a number, which is rounded to a whole one where it changes between events. */
struct Quantity quantity_random(struct Parser *parser, const char *name, struct Quantity seed, struct Quantity number);

/* A function of the language other than a power; b is ignored for one argument. */
struct Quantity quantity_function(struct Parser *parser, enum Operation operation, struct Quantity a,
                                  struct Quantity b);

/* A table of this name at its one or two arguments. */
struct Quantity quantity_of_table(struct Parser *parser, const struct Table *table, const char *name,
                                  const struct Quantity arguments[2]);
