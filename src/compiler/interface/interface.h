/* The variables of the FMU in the order of value references: by kinds, then by their indices. */
#pragma once

#include "lagrangian.h"
#include "mechanics/equations.h"

/* A variable of the FMU, with what only its description needs. */
struct InterfaceVariable {
  struct ScalarVariable entry;    /* as in the generated table */
  const char *unit, *description; /* NULL if unknown */
  const char *display_unit;       /* NULL if none was given */
  double nominal;                 /* NAN if none was given */
  Node node;                      /* the value; ZERO for statistics */
  Node start;                     /* of a state or mode whose start value is an expression; else ZERO */
  bool is_moved_at_start;         /* a state that constraints may change at the end of initialization */
  bool is_continued;       /* a result that is evaluated together with the one before, as components of a vector */
  size_t array_count;      /* number of elements of the array that begins here; 0 for none */
  bool is_further_element; /* an element of an array that began before */
};

enum { OUTPUT_ORDER = 20 }; /* highest derivative of outputs with Taylor series */

/* The variables, ordered by kind and index. */
struct Interface {
  struct InterfaceVariable *variables;
  size_t count;
  size_t count_in_fmi2;                 /* FMI 3.0 also has event indicators, and time even if nothing depends on it */
  size_t first[VARIABLE_INDICATOR + 1]; /* index of the first variable of each kind */
  size_t state_count, result_count;
  bool depends_on_time;
  int output_derivative_order;
};

/* True if initialization computes the state or mode, from its start value among others. */
static inline bool starts_nearby(const struct InterfaceVariable *variable) {
  return has_following_start(&variable->entry) || variable->is_moved_at_start;
}

/* Returns the index in the table of the variable of this kind and index, which must exist. */
size_t interface_find(const struct Interface *interface, enum VariableKind kind, size_t index);

/* Returns the relative tolerance of the solver, 1e-8 by default. */
double interface_tolerance(const struct Model *model);

/* Returns the largest number of solver steps in a communication step; 0 if not limited. */
long interface_max_steps(const struct Model *model);
