/* Hints for constructs of other languages: they end error messages with the right way to write them. */
#pragma once

#include "algebra/graph.h"

/* Returns a hint for the text at `next`, which is not allowed there, such as "; write ^ for a power"; "" for none. */
const char *hint_for_text(const char *begin, const char *next);

/* Returns a hint for a function of other languages; "" for none. */
const char *hint_for_function(const char *name);

/* Returns a hint for an unknown name that other languages have; "" for none. */
const char *hint_for_name(const char *name);

/* Returns a hint for an element that other languages have; "" for none. */
const char *hint_for_element(const char *name);

/* Returns a remedy for symbols of a kind that is not allowed. allowed: the kinds that are, one bit (1 << kind) each. */
const char *hint_for_kind(enum SymbolKind kind, unsigned allowed);
