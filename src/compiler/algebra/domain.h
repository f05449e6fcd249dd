/* Where functions of real numbers have real values, and what an expression asks of its arguments for that. */
#pragma once

#include "algebra/graph.h"
#include "base/diagnostics.h"

/* An argument that must be in the domain of its function. POWER: of a base whose exponent is no whole number. */
struct Requirement {
  enum Operation operation;
  Node argument;
  long line;
};

struct Requirements {
  struct Requirement *items;
  size_t count;
};

bool domain_contains(enum Operation operation, double argument);

/* Completes "expected an argument ...", for a value that is not finite. */
const char *domain_text(enum Operation operation);

/* Notes the argument of an operation, unless that is defined everywhere or the argument is a number. */
void require_domain(struct Requirements *requirements, const struct Graph *graph, enum Operation operation,
                    Node argument, long line);

/* Warns of arguments out of their domains; values: one of each node. Says so once a line and function. */
void warn_outside_domains(const struct Requirements *requirements, const struct Graph *graph, const double *values,
                          const struct Diagnostics *diagnostics);
