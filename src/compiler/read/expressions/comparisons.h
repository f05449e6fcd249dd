/* Conditions: comparisons joined by and, or, not and parentheses. Modes and Boolean parameters are conditions too. */
#pragma once

#include "read/expressions/cursor.h"

/* Parses a condition. The node is constant between events, and positive while the condition holds. */
Node parse_condition(struct Parser *parser);

/* True if the text contains a comparison, also one by =, or one of the words and, or, not. */
bool is_condition(const char *text);

/*
 * Parses when="..." of an event. Returns true with the node of a condition, see parse_condition(). Returns false with
 * an expression, whose zero crossing is the event. After reporting an error, returns false with ZERO.
 */
bool parse_when(struct Scope *scope, const char *text, struct Location location, Node *value);

/* Parses the arguments of if(condition, expression, expression) after the opening parenthesis. */
struct Quantity parse_choice(struct Parser *parser);
