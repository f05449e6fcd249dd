/* Messages about names and functions that an expression cannot use. */
#pragma once

#include "read/expressions/cursor.h"

void report_unknown_name(struct Parser *parser, const char *name);
void report_unknown_function(struct Parser *parser, const char *name);

/* A word of the language that has no value: a function without its argument, or a result. */
void report_reserved(struct Parser *parser, const char *name);
