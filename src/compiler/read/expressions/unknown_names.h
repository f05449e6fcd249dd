/* Error messages for names and functions that an expression cannot use. */
#pragma once

#include "read/expressions/cursor.h"

void report_unknown_name(struct Parser *parser, const char *name);
void report_unknown_function(struct Parser *parser, const char *name);

/* Reports a name without a value in expressions: a function, table or constraint itself, or a result. */
void report_reserved(struct Parser *parser, const char *name);
