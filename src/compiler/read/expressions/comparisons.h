/*
 * Conditions in expressions: comparisons, joined by and, or, not and parentheses. Modes and Boolean parameters are
 * conditions too.
 */
#pragma once

#include "read/expressions/cursor.h"

/* A node that is constant between events, and positive where the condition holds. */
Node parse_condition(struct Parser *parser);

/* True if a text holds a comparison, or a word that joins conditions. */
bool is_condition(const char *text);

/*
 * Reads what an event waits for. True for a condition, see parse_condition(); false for an expression, or after reporting
 * an error, when it is ZERO.
 */
bool parse_when(struct Scope *scope, const char *text, struct Place place, Node *value);

/* The rest of if(condition, expression, expression). */
struct Quantity parse_choice(struct Parser *parser);
