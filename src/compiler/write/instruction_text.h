/* Writes instructions as C statements. The enclosing function declares the names that they use. */
#pragma once

#include <stdio.h>

#include "program/program.h"

/* Writes an operand or result in its role; target is the name of the array SPACE_TARGET. */
void write_slot(FILE *file, const struct Program *program, Slot slot, enum Role role, const char *target);

/* Writes the statements of a function; without a target, a value for it is returned. */
void write_statements(FILE *file, const struct Program *program, const struct IrFunction *ir, const char *target);

/*
 * Writes the statements of an order of series; the middle terms of products are in m (SERIES_MIDDLES of
 * include/series.h).
 */
void write_statements_around(FILE *file, const struct Program *program, const struct IrFunction *ir);

/* Write the macro that lists these products, or the array of their factors. Return their number. */
size_t write_products(FILE *file, const struct Program *program, const struct IrFunction *ir);
size_t write_factors(FILE *file, const struct Program *program, const struct IrFunction *ir);
