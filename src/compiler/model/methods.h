/*
 * The methods of <solver>, as the compiler knows them. A new method needs an entry here, its name in fmu/system.xsd and
 * its file in src/runtime/methods/.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* Use of the Taylor series of the motion. */
enum SeriesUse {
  NO_SERIES,
  FIRST_TERMS, /* a few, to bound the step */
  ALL_TERMS
};

enum { METHOD_SOURCES = 10 };

/* A row of the table: the properties of a method. */
struct Method {
  const char *name;          /* in system.xml and on the command line */
  const char *solver;        /* name of its file, and of its struct Solver after "solver_" */
  const char *sparse_solver; /* the solver for a large sparse Jacobian; NULL for none */
  const char *sentence;      /* for the documentation */
  const char *evaluations;   /* description of the statistic derivativeEvaluations; NULL if it counts none */
  /* Other source files that it needs. */
  const char *sources[METHOD_SOURCES];
  enum SeriesUse series;
  bool needs_jacobian; /* it counts the Jacobian's evaluations */
  bool hands_over;     /* it switches between methods, and counts how often */
  bool factors; /* it factors matrices with a row for each velocity and first-order state, by lagrangian.implicit.lu */
  bool needs_linear; /* it solves only linear systems, in one step for each communication step */
  bool uses_library; /* it uses an external library, which allocates memory itself */
};

/* Returns a method; NULL if there is none of this name. */
const struct Method *method_named(const char *name);

/* Returns "a, b or c". */
char *method_names(void);

/* Returns the solver for a Jacobian with these numbers of rows and nonzero elements. */
const char *method_solver(const struct Method *method, size_t rows, size_t elements);
