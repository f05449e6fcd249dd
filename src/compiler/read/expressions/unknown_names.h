/* Error messages for names and functions that an expression cannot use. */
#pragma once

#include "read/expressions/cursor.h"

void report_unknown_name(struct Parser *parser, const char *name);
void report_unknown_function(struct Parser *parser, const char *name);

/*
 * Reports a reserved name that has no value in expressions: a function or table without its argument, a constraint, or
 * a result.
 */
void report_reserved(struct Parser *parser, const char *name);
