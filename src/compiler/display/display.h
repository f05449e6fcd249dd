/*
 * Expressions as a textbook prints them, as text in the language of system.xml. cos(a - b) replaces products of
 * sines and cosines, and parameters are collected in factors such as (m1 + m2). Accelerations come before squares
 * of velocities, then other terms and inputs. Only the text differs; the value is that of the node but for
 * rounding.
 *
 * The text is the shortest of several: with and without products that are multiplied out (terms.h), and as a reduced
 * fraction. Expressions beyond the limits of terms.h, and those of systems that take many steps, keep the form of
 * formula.h.
 */
#pragma once

#include "algebra/formula.h"

struct Display {
  struct Graph *graph;
  const struct NodeNames *names;
  char **known; /* texts of nodes inside of others; NULL if unknown */
  size_t known_count;
  int depth;        /* of texts inside of others */
  size_t work_left; /* graph_work_left() at the first text; 0 before it */
};

/* Returns a node of equal value, multiplied out and shortened by addition theorems; the node itself if it is large. */
Node display_node(struct Display *display, Node node);

/* Returns the text of a node; subexpressions that have names are shown by them. */
char *display_text(struct Display *display, Node node);
