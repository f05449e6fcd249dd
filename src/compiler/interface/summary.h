/* The formulas that the documentation shows, in their readable form; those of large systems in part. */
#pragma once

#include "algebra/formula.h"
#include "mechanics/equations.h"

enum { SHOWN_LIMIT = 100 }; /* equations of motion, outputs, and definitions, that a page shows */

struct Summary {
  struct NodeNames names;         /* of the author's calculated parameters and definitions that are shown */
  Node lagrangian_kinetic;        /* K of L = K - U */
  Node kinetic, potential, power; /* as in struct Equations; potential is U of L where nothing is linearised */
  bool is_autonomous;             /* L does not depend on time explicitly */
  Node *inertial, *right_side;    /* M a = right side, of the first equations */
  Node *reactions;                /* of the first forces of reaction */
  Node *rates;                    /* of the first states, which may hold accelerations and forces */
  Node *outputs;                  /* of the first outputs */
  size_t motion_count, reaction_count, rate_count, output_count; /* how many are shown */
};

struct Summary *summary_create(const struct Model *model, const struct Equations *equations);
