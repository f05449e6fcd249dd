/* The shapes of an icon: lines, dots and filled polygons, in drawing order. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* The looks of shapes, named after the parts that they show; each has a row in the table of struct LookStyle. */
enum Look { GROUND, SOLID, LINK, BAR, PARTICLE, JOINT, SIGNAL, RIM, FLANGE, LOOK_COUNT };

/* How shapes of one look are drawn, in a picture of PICTURE_SIZE pixels. */
struct LookStyle {
  double width;            /* line width or diameter of dots, in pixels */
  double opacity;          /* of filled polygons; lines and dots are opaque */
  unsigned char colour[3]; /* red, green, blue on white */
};

/* Side of a picture, in pixels. */
enum { PICTURE_SIZE = 160 };

extern const struct LookStyle looks[LOOK_COUNT];

/* A point of the picture, in m before fit_drawing(), in pixels after it. */
struct PicturePoint {
  double right, up;
};

/* A dot if it has one point. */
struct PictureShape {
  enum Look look;
  bool is_filled; /* a convex polygon, else a polyline */
  struct PicturePoint *points;
  size_t count;
};

/* Shapes from the back to the front. */
struct Drawing {
  struct PictureShape *shapes;
  size_t count;
};

/* Appends a polygon, filled or not, or a dot; it copies the points. */
void append_shape(struct Drawing *drawing, enum Look look, bool is_filled, const struct PicturePoint *points,
                  size_t count);

/* Appends the convex hull of the points: filled with an edge, or the edge alone. */
void append_hull(struct Drawing *drawing, enum Look look, bool is_filled, const struct PicturePoint *points,
                 size_t count);

/* The bounding box of all points; least is greater than most without points. */
struct Rectangle {
  struct PicturePoint least, most;
};

/* Returns the bounding rectangle of all shapes. */
struct Rectangle rectangle_of(const struct Drawing *drawing);

/*
 * Scales and centres the drawing in PICTURE_SIZE pixels, with x to the right and y down. Returns false if it has no
 * extent.
 */
bool fit_drawing(struct Drawing *drawing);
