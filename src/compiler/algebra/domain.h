/* Domains of real functions, and the conditions that an expression imposes on its arguments. */
#pragma once

#include "algebra/graph.h"
#include "base/diagnostics.h"

/* An argument that must be in the domain of its function. POWER: a base whose exponent is not whole. */
struct Requirement {
  enum Operation operation;
  Node argument;
  long line;
};

struct Requirements {
  struct Requirement *items;
  size_t count;
};

/* True if the function has a real value at the argument. */
bool domain_contains(enum Operation operation, double argument);

/* Returns the end of "expected an argument ..." for a value that is not finite. */
const char *domain_text(enum Operation operation);

/* Adds the argument to the requirements, unless it is a number or the operation is defined everywhere. */
void require_domain(struct Requirements *requirements, const struct Graph *graph, enum Operation operation,
                    Node argument, long line);

/* Warns of arguments outside their domains, once for each line and function; values has one element for each node. */
void warn_outside_domains(const struct Requirements *requirements, const struct Graph *graph, const double *values,
                          const struct Diagnostics *diagnostics);
