/* Recursive-descent parser of expressions. It builds nodes of the expression graph and checks units on the way. */
#pragma once

#include "read/expressions/cursor.h"

/*
 * Parses an expression. Errors are reported with their lines; the result is then 0 with an unknown unit.
 *
 *   sum      = term { ("+" | "-") term }
 *   term     = sign { ("*" | "/") sign }
 *   sign     = { "-" | "+" } power
 *   power    = primary [ "^" sign ]
 *   primary  = number | name | name "(" sum { "," sum } ")" | "(" sum ")"
 *            | "sum" "(" index "," first "," last "," sum ")" | "der" "(" sum ")"
 *            | "diff" "(" sum "," name ")" | "integral" "(" name "," sum "," sum "," sum [ "," sum ] ")"
 *            | "distance" "(" vector "," vector ")" | "dot" "(" vector "," vector ")" | "norm" "(" vector ")"
 *   name     = part { "." part }
 *   part     = identifier [ "[" index expression "]" ]
 *   vector   = [ "-" ] scaled { ("+" | "-") scaled }
 *   scaled   = [ power { ("*" | "/") power } "*" ] arrow { ("*" | "/") power }, where the first power is no parenthesis
 *   arrow    = name | "cross" "(" vector "," vector ")" | "(" vector ")"
 */
struct Quantity parse_expression(struct Scope *scope, const char *text, struct Location location);

/* Parses a sum at the reading position, as far as it extends. */
struct Quantity parse_sum(struct Parser *parser);

/* Parses the whole text by the function `read`; reports text that is left over. */
struct Quantity parse_whole_text(struct Parser *parser, struct Quantity (*read)(struct Parser *parser));

/* Parses a power or primary, as a factor of a product. */
struct Quantity parse_power(struct Parser *parser);

/*
 * Parses a name that a call declares, and the comma after it, such as the index of sum(index, first, last, expression).
 * usage: that form, for messages.
 */
char *parse_declared(struct Parser *parser, const char *what, const char *usage);

/* Reports an index or variable that a call declares and that is already defined. */
void require_new_name(struct Parser *parser, const char *what, const char *name, const char *function);

/* Parses an expression of compile-time numbers whose value must be an integer. */
long parse_whole(struct Parser *parser, const char *what);

/* Reads a name at the reading position and evaluates its indices. */
char *read_name(struct Parser *parser);

/* Returns the value of a name. Reports a name that is unknown or not allowed here. */
struct Quantity look_up(struct Parser *parser, const char *name);

/* Parses an expression of compile-time numbers. Returns false after reporting an error. */
bool parse_constant(struct Scope *scope, const char *text, struct Location location, struct Quantity *value);

/* Like parse_constant(), without the unit. */
bool parse_number(struct Scope *scope, const char *text, struct Location location, double *value);

/*
 * Evaluates the indices in a name: theta[i+1] becomes theta[3]. parts: the name may have several parts, as motor.theta.
 * Returns NULL after reporting an error.
 */
char *parse_name(struct Scope *scope, const char *text, struct Location location, bool parts);
