/* All expressions that the generated C computes: what derivation gave, differentiated once more where needed. */
#ifndef PROGRAM_H
#define PROGRAM_H

#include "mechanics/interface.h"
#include "mechanics/lagrange.h"
#include "mechanics/linearize.h"
#include "program/series_plan.h"

struct Program {
  const struct Model *model;
  const struct Equations *equations;
  const struct Interface *interface;
  struct LinearSystem *linear;      /* NULL unless the solver is exact */
  struct SeriesPlan *series;        /* of the motion; NULL unless the solver is taylor */
  struct SeriesPlan *output_series; /* NULL where outputs have no derivatives above the first, or are variables */
  Node *along;                      /* derivative of the accelerations, or right sides for it in large blocks */
  Node power_along;
  Node *jacobian; /* count rows by state_count columns, as along for each state; NULL unless the solver asks */
  Node *power_jacobian;
  Node *result_along; /* one for each result; ZERO unless it is an output */
};

/* Reports errors where the chosen solver does not fit the system; NULL then. */
struct Program *program_create(struct Model *model, const struct Equations *equations,
                               const struct Interface *interface, struct Diagnostics *diagnostics);
void program_free(struct Program *program);

#endif
