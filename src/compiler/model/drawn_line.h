/*
 * <line>: lines that are drawn, without mechanics. Their expressions have a graph of their own, a copy of the
 * model's with further nodes. So drawings never change the order of terms in the equations.
 */
#pragma once

#include <stdbool.h>

#include "algebra/graph.h"

enum LineKind {
  LINE_ROD,
  LINE_ROPE,
  LINE_SPRING,
  LINE_DAMPER,
  LINE_BELT,
  LINE_HOOP,
  LINE_WHEEL,
  LINE_GROUND,
  LINE_PIVOT,
  LINE_ARROW
};
enum { LINE_KINDS = LINE_ARROW + 1 };

/* Names in kind="...". */
extern const char *const line_kind_names[LINE_KINDS];

/* A point in m along the base's axes. */
struct LineEnd {
  const char *name;       /* of the object or frame that is there; "" for the base; NULL if formulas give the point */
  const char *formula[3]; /* of variables of the FMU */
  Node position[3];
};

struct DrawnLine {
  enum LineKind kind;
  struct LineEnd ends[2]; /* a pivot has the first one alone */
  Node radius;            /* m; ZERO for the page's choice */
  const char *radius_formula;
  int axis;          /* of a hoop, wheel or belt: x, y or z of the base is its normal */
  const char *color; /* as that of a shape; NULL for the page's choice */
  bool has_trail;    /* pages draw the path of its last end */
  bool is_guessed;   /* of a <spring>; beside it, rods and joints are guessed */
  long line;
};

struct LineDrawing {
  struct Graph *graph; /* NULL without lines */
  struct DrawnLine *lines;
  size_t count;
};

/* True if the author draws the system by <line> elements. */
bool has_described_lines(const struct LineDrawing *drawing);

/* True for a line with two ends. */
bool has_two_ends(const struct DrawnLine *line);
