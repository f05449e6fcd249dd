/* The expression language: plain infix text to nodes, with dimensions checked on the way. */
#pragma once

#include "read/expressions/cursor.h"

/*
 * Parses an expression. Errors are reported with their line, and the result is then 0 with an unknown dimension.
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
struct Quantity parse_expression(struct Scope *scope, const char *text, struct Place place);

/* The same from the reading position on, as far as it goes. */
struct Quantity parse_sum(struct Parser *parser);

/* The same to the end of the text, or what another function reads of it. */
struct Quantity parse_whole_text(struct Parser *parser, struct Quantity (*read)(struct Parser *parser));

/* A power or primary, as a factor of a product. */
struct Quantity parse_power(struct Parser *parser);

/* The name that a call declares, as the index of sum(index, first, last, expression), whose form the usage is. */
char *parse_declared(struct Parser *parser, const char *what, const char *usage);

/* A whole number from an expression of compile-time numbers. */
long parse_whole(struct Parser *parser, const char *what);

/* A name at the reading position, its indices worked out. */
char *read_name(struct Parser *parser);

/* The value of a name, which must be allowed in this place. */
struct Quantity look_up(struct Parser *parser, const char *name);

/* Parses an expression of numbers and compile-time numbers alone. Returns false after reporting an error. */
bool parse_constant(struct Scope *scope, const char *text, struct Place place, struct Quantity *value);

/* The same without the unit. */
bool parse_number(struct Scope *scope, const char *text, struct Place place, double *value);

/*
 * Replaces the indices in a name by their values: theta[i+1] to theta[3]. parts: whether it may have several, as in
 * motor.theta. Returns NULL after reporting an error.
 */
char *parse_name(struct Scope *scope, const char *text, struct Place place, bool parts);
