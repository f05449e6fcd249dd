/* The names that an expression may use, and what they stand for. */
#pragma once

#include "algebra/differentiate.h"
#include "algebra/domain.h"
#include "algebra/units/quantity.h"
#include "base/diagnostics.h"
#include "read/names/names.h"

struct Definitions;
struct Model;
struct Switches;

/* The variable of an integral or a derivative while its expression is read, which is between two values. */
struct Dummy {
  Node symbol, low, high;
};

enum { DUMMY_LIMIT = 20 };

struct Scope {
  struct Graph *graph;
  struct Diagnostics *diagnostics;
  struct Names *names;               /* name -> struct Entry */
  bool checks_units;                 /* some variable has a unit; a file without any is free of them */
  struct Requirements requirements;  /* of all expressions read */
  struct Names *tables;              /* full name -> struct Table, see table.h */
  struct Names *functions;           /* full name -> struct NamedFunction, see named_functions.h */
  struct Definitions *definitions;   /* names that may become known; NULL for none */
  struct Switches *switches;         /* the model's; NULL where all expressions stay whole, as for a linearisation */
  Node *time_derivatives;            /* one node a symbol: d symbol / dt; ZERO for parameters and modes */
  size_t time_derivative_count;      /* of the symbols so far; branches make some without the scope */
  struct Derivatives rates;          /* d node / dt of what has been asked for */
  const char *prefix;                /* of the names of the file being read: "motor." of an included one, else "" */
  bool keeps_whole;                  /* the present expression stays whole */
  struct Dummy dummies[DUMMY_LIMIT]; /* those outside come first; each is used again and again */
  size_t dummy_count;                /* around the reading position */
  const struct Model *model;         /* whose start values integrals look at */
  struct Names *noted_integrals;     /* "file:line:text" of those that a message has named */
  struct Names *warned_numbers;      /* "file:line:number" of those that a warning has named */
  long table_line;                   /* where the present table is used */
};

struct Scope *scope_create(struct Graph *graph, struct Diagnostics *diagnostics);

/* Makes a name known. Where it is taken already, reports this and returns false. */
bool scope_define(struct Scope *scope, const char *name, struct Quantity quantity, long line);

/* Gives a known name the unit that it turns out to have. */
void scope_set_dimension(struct Scope *scope, const char *name, struct Dimension dimension);

/* A compile-time number; a second definition replaces the first. */
void scope_set_number(struct Scope *scope, const char *name, double value);

/* The same for the index of a loop, until it is removed. */
void scope_set_index(struct Scope *scope, const char *name, double value);
void scope_remove_index(struct Scope *scope, const char *name);
void scope_remove(struct Scope *scope, const char *name);

/* Whether the name is the index of a <for>. */
bool scope_is_index(const struct Scope *scope, const char *name);

/* NULL where the name is unknown. */
const struct Quantity *scope_find(const struct Scope *scope, const char *name);

/* What the file being read calls by this name: with the prefix of the file, unless it is a word of the language. */
char *scope_full_name(const struct Scope *scope, const char *name);

/* The line for messages that come when no longer its file is read, as by note_line(). */
long scope_line(const struct Scope *scope, long line);

/* Whether a known name is a word of the language that has no value, such as that of a function. */
bool scope_is_reserved(const struct Scope *scope, const struct Quantity *quantity);

/* The name of a value that was meant by an unknown one, as the file being read calls it, or NULL; see similar.h. */
const char *scope_similar_name(const struct Scope *scope, const char *name);

/* Whether two quantities may be added; always true where units are not checked. */
bool scope_units_agree(const struct Scope *scope, struct Dimension first, struct Dimension second);

/* Adds a symbol to graph and scope; scope_set_time_derivative sets its time derivative, before one is taken of anything. */
Node scope_symbol(struct Scope *scope, enum SymbolKind kind, int index, const char *name, struct Dimension dimension,
                  long line);
void scope_set_time_derivative(struct Scope *scope, Node symbol, Node derivative);

/* As it was set; ZERO for a symbol of which none was. */
Node time_derivative_of_symbol(const struct Scope *scope, Node symbol);

/* d node / dt by the chain rule, the part explicit in time included. */
Node total_time_derivative(struct Scope *scope, Node node);
