/* One instruction as one C statement, with the names that the functions around it declare. */
#pragma once

#include <stdio.h>

#include "program/program.h"

/* An operand, or a result, in its role; target is the name of what SPACE_TARGET is. */
void write_place(FILE *file, const struct Program *program, Place place, enum Role role, const char *target);

/* The statements of a routine; without a target, values for it are returned. */
void write_statements(FILE *file, const struct Program *program, const struct Routine *routine, const char *target);

/* The statements of an order of series, whose products have their middle terms in m (SERIES_MIDDLES of include/series.h). */
void write_statements_around(FILE *file, const struct Program *program, const struct Routine *routine);

/* The macro that lists these products, or the array of their factors; both return how many there are. */
size_t write_products(FILE *file, const struct Program *program, const struct Routine *routine);
size_t write_factors(FILE *file, const struct Program *program, const struct Routine *routine);
