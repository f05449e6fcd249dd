/*
 * An expression as a sum of monomials: a coefficient times powers of atoms. Atoms are symbols, functions, named
 * expressions, and the sums that are not multiplied out.
 */
#pragma once

#include "algebra/formula.h"

/* Limits of a displayed sum; larger expressions keep the form in which they are computed. */
enum { ATOM_ROOM = 48, TERM_ROOM = 200 };

/* Which products of sums are multiplied out, and powers of sums; products of accelerations always are. */
enum ProductExpansion {
  EXPAND_NONE,
  EXPAND_QUADRATIC, /* those of degree 2 and more in velocities, so that terms of inertia come together */
  EXPAND_ALL
};

struct Term {
  double coefficient;
  double magnitude; /* of the largest partial sum that led to the coefficient; 0: the coefficient is no sum */
  double exponents[ATOM_ROOM];
};

struct Terms {
  struct Term *items;
  size_t count;
};

struct Atoms {
  struct Graph *graph;
  const struct NodeNames *names;
  Node whole; /* the displayed expression, which is not replaced by its name */
  enum ProductExpansion expansion;
  Node nodes[ATOM_ROOM];
  int count;
  size_t visits;
  int depth;    /* of the recursion */
  bool is_full; /* a limit was exceeded */
};

/* Returns the name that stands for a node below the whole; NULL for none. */
const char *displayed_name(const struct Atoms *atoms, Node node);

/* Returns the terms of a node; they have no meaning if atoms->is_full. */
struct Terms terms_of_expression(struct Atoms *atoms, Node node);

/* Returns the sum of the terms as a node. */
Node node_of_terms(const struct Atoms *atoms, const struct Terms *terms);

/* Returns the index of an atom, which is added if it is new. */
int atom_index(struct Atoms *atoms, Node node);

/* Adds a term to a sum; a term with the same atoms absorbs it. Coefficients that cancel but for rounding leave none. */
void add_to_terms(struct Atoms *atoms, struct Terms *terms, const struct Term *term);

bool have_equal_atoms(const struct Term *a, const struct Term *b);
