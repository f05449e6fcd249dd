/* The variables of the FMU in the order of their value references. */
#ifndef INTERFACE_H
#define INTERFACE_H

#include "lagrangian.h"
#include "mechanics/lagrange.h"

struct InterfaceVariable {
  struct ScalarVariable entry; /* as in the generated table; the name belongs to this structure */
  char *unit, *description;    /* NULL where unknown */
  double nominal;              /* NAN where none was given */
  Node node;                   /* the value; ZERO for statistics */
};

enum { OUTPUT_ORDER = 20 }; /* the highest derivative of outputs that have Taylor series */

struct Interface {
  struct InterfaceVariable *variables;
  size_t count;
  size_t state_count, result_count;
  bool depends_on_time;
  const struct Method *method; /* the one that is used; NULL for a system without coordinates */
  int output_derivative_order;
};

struct Interface *interface_create(const struct Model *model, const struct Equations *equations);
void interface_free(struct Interface *interface);

/* The place in the table of the variable of this kind and index. */
size_t interface_find(const struct Interface *interface, enum VariableKind kind, size_t index);

/* The relative tolerance of the solver, and the experiment with its defaults filled in. */
double interface_tolerance(const struct Model *model);

/*
 * How the value of a node depends on a symbol (FMI 2.0.4, section 2.2.8): not at all, with a constant factor, with a
 * factor of parameters, or otherwise.
 */
enum Dependency { INDEPENDENT, CONSTANT_FACTOR, TUNABLE_FACTOR, DEPENDENT };

/*
 * The dependency of every node on symbol, accelerations included by way of the equations of motion. Nodes that stand
 * for accelerations of large blocks depend on what their block depends on. Free with free().
 */
enum Dependency *dependencies_on(const struct Graph *graph, const struct Equations *equations, Node symbol);

#endif
