/* Constructs of expressions, which the parser reads after their opening parenthesis, and its messages about names. */
#pragma once

#include "read/expressions/cursor.h"

/* Parses diff(expression, name): the partial derivative, other names constant. */
struct Quantity parse_partial_derivative(struct Parser *parser);

/* Parses integral(name, from, to, expression [, nodes]). */
struct Quantity parse_integral(struct Parser *parser);

/* True if the name is that of a function of vectors: cross, distance, dot or norm. */
bool is_function_of_vectors(const char *name);

/*
 * Parses the arguments of such a function and its closing parenthesis. Vectors are points, their velocities, axes of
 * frames, angular velocities and combinations of these, along the base's axes. Reports cross, which is no scalar.
 */
struct Quantity parse_function_of_vectors(struct Parser *parser, const char *name);

/* Parses the arguments of if(condition, expression, expression). */
struct Quantity parse_choice(struct Parser *parser);

/*
 * Parses a condition: comparisons joined by and, or, not and parentheses; modes and Boolean parameters are conditions
 * too. The node is constant between events, and positive while the condition holds.
 */
Node parse_condition(struct Parser *parser);

/* True if the text contains a comparison, also one by =, or one of the words and, or, not. */
bool is_condition(const char *text);

/*
 * Parses when="..." of an event. Returns true with the node of a condition, see parse_condition(). Returns false with
 * an expression, whose zero crossing is the event. After reporting an error, returns false with ZERO.
 */
bool parse_when(struct Scope *scope, const char *text, struct Location location, Node *value);

/* Report names and functions that an expression cannot use. */
void report_unknown_name(struct Parser *parser, const char *name);
void report_unknown_function(struct Parser *parser, const char *name);

/* Reports a name without a value in expressions: a function, table or constraint itself, or a result. */
void report_reserved(struct Parser *parser, const char *name);
