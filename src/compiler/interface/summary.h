/* The formulas of the documentation page, in readable form; of large systems, the first ones. */
#pragma once

#include "algebra/formula.h"
#include "mechanics/equations.h"

enum { SHOWN_LIMIT = 100 }; /* most equations of motion, outputs and definitions on the page */

/* Expressions for the page, without modes of branches. */
struct Summary {
  struct NodeNames names;         /* of calculated parameters and definitions that are shown */
  Node lagrangian_kinetic;        /* K of L = K - U */
  Node kinetic, potential, power; /* as in struct Equations; potential is U of L unless linearized */
  bool is_autonomous;             /* L does not depend on time explicitly */
  Node *inertial, *right_side;    /* M a = right_side, of the first equations */
  Node *constraints;              /* of the first constraints while they hold; of contacts, the gap */
  Node *reactions;                /* of the first reaction forces */
  Node *rates;                    /* of the first states; may contain accelerations and forces */
  Node *outputs;                  /* of the first outputs */
  size_t constraint_count, motion_count, reaction_count, rate_count,
      output_count; /* numbers of formulas that are shown */
};

/* Returns the formulas of a model and its equations. */
struct Summary *summary_create(const struct Model *model, const struct Equations *equations);
