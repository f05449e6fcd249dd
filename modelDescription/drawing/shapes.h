/* What a drawing is made of: lines, dots and filled polygons on the paper, in the order in which they are drawn. */
#ifndef SHAPES_H
#define SHAPES_H

#include <stdbool.h>
#include <stddef.h>

enum Look { GROUND, AXIS, SOLID, EDGE, LINK, BAR, BASE, HOLE, PARTICLE, JOINT, BOX, SIGNAL, LOOK_COUNT };

/* How a look is drawn in a picture whose sides are PICTURE_SIZE; the classes are those of page.css and of the icon's style. */
struct LookStyle {
  const char *name;
  double width;            /* of lines, and the diameter of dots */
  double opacity;          /* of filled polygons; lines and dots hide what is behind them */
  unsigned char colour[3]; /* on white paper */
};

enum { PICTURE_SIZE = 160 };

extern const struct LookStyle looks[LOOK_COUNT];

struct Spot {
  double right, up;
};

/* One point: a dot. */
struct Shape {
  enum Look look;
  bool is_filled; /* a convex polygon, else a line through the points */
  struct Spot *points;
  size_t count;
};

struct Drawing {
  struct Shape *shapes;
  size_t count;
};

void append_shape(struct Drawing *drawing, enum Look look, bool is_filled, const struct Spot *points, size_t count);
void append_line(struct Drawing *drawing, enum Look look, struct Spot from, struct Spot to);

/* The smallest rectangle that holds all points; its least corner is beyond its greatest where there are none. */
struct Rectangle {
  struct Spot least, most;
};

struct Rectangle rectangle_of(const struct Drawing *drawing);

/* Puts it into the middle of a picture of PICTURE_SIZE, in pixels to the right and down; false where it has no size. */
bool fit_drawing(struct Drawing *drawing);

/* The convex hull of points, which are sorted here; returns its number of points, which come first in hull[2 count]. */
size_t convex_hull(struct Spot *points, size_t count, struct Spot *hull);

#endif
