/*
 * The methods of <solver>, as the compiler knows them. A new one has an entry here, a place in fmu/system.xsd and its
 * file in src/runtime/methods/.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* What a method takes of the Taylor series of the motion. */
enum SeriesUse {
  NO_SERIES,
  FIRST_TERMS, /* to see how far a step may go */
  ALL_TERMS
};

enum { METHOD_SOURCES = 10 };

struct Method {
  const char *name;          /* in system.xml and on the command line */
  const char *solver;        /* names its file, and with solver_ before it, its struct Solver */
  const char *sparse_solver; /* the one for a large sparse Jacobian; NULL for none */
  const char *sentence;      /* for the documentation */
  const char *evaluations;   /* what derivativeEvaluations counts; NULL for nothing */
  /* The other files that it needs. */
  const char *sources[METHOD_SOURCES];
  enum SeriesUse series;
  bool needs_jacobian; /* and counts its evaluations */
  bool hands_over;     /* between methods, and counts how often */
  bool factors;        /* matrices with a row and a column for each coordinate, by lagrangian.implicit.lu */
  bool needs_linear;   /* solves linear systems alone, as a whole communication step */
  bool uses_library;   /* which no FMU carries in C, and which allocates by itself */
};

/* NULL where there is no method of this name. */
const struct Method *method_named(const char *name);

/* "a, b or c". */
char *method_names(void);

/* The solver for a Jacobian with so many rows and elements other than 0. */
const char *method_solver(const struct Method *method, size_t rows, size_t elements);
