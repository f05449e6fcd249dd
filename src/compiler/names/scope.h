/* The scope: names that expressions may use, and their meanings. */
#pragma once

#include "algebra/differentiate.h"
#include "algebra/domain.h"
#include "algebra/units/quantity.h"
#include "base/diagnostics.h"
#include "names/names.h"

struct Definitions;
struct Model;
struct Switches;

/* The variable of an integral or a derivative while its expression is parsed, with the bounds of its interval. */
struct DummyVariable {
  Node symbol, low, high;
};

/* Largest depth of nested integrals and derivatives. */
enum { DUMMY_LIMIT = 20 };

/* The names of a system while its files are read. */
struct Scope {
  struct Graph *graph;
  struct Diagnostics *diagnostics;
  struct Names *names;              /* name -> struct ScopeEntry */
  bool checks_units;                /* some variable has a unit; a file without units is not checked */
  struct Requirements requirements; /* domains of functions in all expressions parsed */
  struct Names *tables;             /* full name -> struct Table, see table.h */
  struct Names *functions;          /* full name -> struct NamedFunction, see named_functions.h */
  struct Definitions *definitions;  /* names that are still to be parsed; NULL for none */
  struct Switches *switches;        /* of the model; NULL if piecewise functions stay whole, as in a linearization */
  Node *time_derivatives;           /* per symbol: its time derivative; ZERO for parameters and modes */
  size_t time_derivative_count;     /* symbols that have an entry; modes are added only to the graph */
  struct Derivatives rates;         /* cache of total_time_derivative() */
  const char *prefix;               /* of names in the current file: "motor." if it is included, else "" */
  bool keeps_whole;                 /* piecewise functions of the current expression stay whole */
  struct DummyVariable dummies[DUMMY_LIMIT]; /* the outermost first; their symbols are reused */
  size_t dummy_count;                        /* dummies that are valid at the reading position */
  const struct Model *model;                 /* for the start values at which integrals are tested */
  struct Names *noted_integrals;             /* "file:line:text" of those that a message has reported */
  struct Names *warned_numbers;              /* "file:line:number" of those that a warning has reported */
  long table_line;                           /* on which the current table is used */
  Node relevance; /* new branches matter where it is positive: elsewhere they have no events, and their modes are 0 */
};

/* Returns a scope without names, which reports to the diagnostics. */
struct Scope *scope_create(struct Graph *graph, struct Diagnostics *diagnostics);

/* Defines a name. Returns false after reporting that it is already defined. */
bool scope_define(struct Scope *scope, const char *name, struct Quantity quantity, long line);

/* Sets the unit of a defined name once it is known. */
void scope_set_dimension(struct Scope *scope, const char *name, struct Dimension dimension);

/* Defines a compile-time number; a second definition replaces the first. */
void scope_set_number(struct Scope *scope, const char *name, double value);

/* Define and remove the index of a loop, a compile-time number; scope_remove() removes any name. */
void scope_set_index(struct Scope *scope, const char *name, double value);
void scope_remove_index(struct Scope *scope, const char *name);
void scope_remove(struct Scope *scope, const char *name);

/* True if the name is the index of a <for>. */
bool scope_is_index(const struct Scope *scope, const char *name);

/* Returns the meaning of a full name; NULL if it is unknown. */
const struct Quantity *scope_find(const struct Scope *scope, const char *name);

/* Returns the full name of a name in the current file: with the file's prefix, unless it is a word of the language. */
char *scope_full_name(const struct Scope *scope, const char *name);

/* Returns the number of a line of the current file for messages after it has been read; see note_line(). */
long scope_line(const struct Scope *scope, long line);

/* True if a defined name is a word without a value, such as the name of a function. */
bool scope_is_reserved(const struct Scope *scope, const struct Quantity *quantity);

/* Returns the most similar known name, without the current file's prefix; NULL for none. See similar.h. */
const char *scope_similar_name(const struct Scope *scope, const char *name);

/* True if two quantities may be added; always true if units are not checked. */
bool scope_units_agree(const struct Scope *scope, struct Dimension first, struct Dimension second);

/* Adds a symbol to graph and scope. Its time derivative must be set before any derivative is taken. */
Node scope_symbol(struct Scope *scope, enum SymbolKind kind, int index, const char *name, struct Dimension dimension,
                  long line);
void scope_set_time_derivative(struct Scope *scope, Node symbol, Node derivative);

/* Returns the time derivative of a symbol; ZERO if none was set. */
Node time_derivative_of_symbol(const struct Scope *scope, Node symbol);

/* Returns d node / dt by the chain rule, including the explicit dependence on time. */
Node total_time_derivative(struct Scope *scope, Node node);
