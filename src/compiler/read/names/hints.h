/* The right way to write what other languages write otherwise: ends of messages about expressions. */
#pragma once

#include "algebra/graph.h"

/* For what stands at `next` in an expression and is no part of the language there, such as "; write ^ for a power". */
const char *hint_for_text(const char *begin, const char *next);

/* For a function of other languages; "" where there is none. */
const char *hint_for_function(const char *name);

/* For a name of other languages that is unknown in this one; "" where there is none. */
const char *hint_for_name(const char *name);

/* For an element of other languages, what to write instead; "" where there is nothing known. */
const char *hint_for_element(const char *name);

/* What to do instead of using symbols of a kind where only those of others are allowed, one bit (1 << kind) each. */
const char *hint_for_kind(enum SymbolKind kind, unsigned allowed);
