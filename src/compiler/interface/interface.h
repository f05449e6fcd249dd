/*
 * The variables of the FMU in the order of their value references. Those of one kind stand together, in the order of their
 * indices.
 */
#pragma once

#include "lagrangian.h"
#include "mechanics/equations.h"

struct InterfaceVariable {
  struct ScalarVariable entry;    /* as in the generated table */
  const char *unit, *description; /* NULL where unknown */
  const char *display_unit;       /* NULL where none was given */
  double nominal;                 /* NAN where none was given */
  Node node;                      /* the value; ZERO for statistics */
  Node start;                     /* of a state whose start value follows from parameters; else ZERO */
  bool is_moved_at_start;         /* a state that constraints may move as initialization ends */
  bool is_continued;              /* a result that is computed together with the one before: components of one thing */
  size_t array_count;             /* elements of the array that begins with this variable; 0 where none does */
  bool is_further_element;        /* of an array that began before */
};

enum { OUTPUT_ORDER = 20 }; /* the highest derivative of outputs that have Taylor series */

struct Interface {
  struct InterfaceVariable *variables;
  size_t count;
  size_t count_in_fmi2;                 /* FMI 3.0 has more: event indicators, and time where nothing depends on it */
  size_t first[VARIABLE_INDICATOR + 1]; /* the place of the first variable of each kind */
  size_t state_count, result_count;
  bool depends_on_time;
  int output_derivative_order;
};

/* Whether initialization computes the state, from its start value among others. */
static inline bool starts_nearby(const struct InterfaceVariable *variable) {
  return has_following_start(&variable->entry) || variable->is_moved_at_start;
}

/* The place in the table of the variable of this kind and index, which there is. */
size_t interface_find(const struct Interface *interface, enum VariableKind kind, size_t index);

/* The relative tolerance of the solver. */
double interface_tolerance(const struct Model *model);

/* How many steps a solver may take in one communication step. */
long interface_max_steps(const struct Model *model);
