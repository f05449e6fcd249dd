/* The shapes of a drawing: lines, dots and filled polygons, in drawing order. */
#ifndef PICTURE_SHAPES_H
#define PICTURE_SHAPES_H

#include <stdbool.h>
#include <stddef.h>

/* The looks of shapes, named after the parts that they show; each has a row in the table of struct LookStyle. */
enum Look { GROUND, AXIS, SOLID, EDGE, LINK, ROPE, BAR, BASE, HOLE, PARTICLE, JOINT, BOX, SIGNAL, LOOK_COUNT };

/*
 * How shapes of one look are drawn, in a picture of PICTURE_SIZE pixels; name is a class of page.css and of the icon's
 * style.
 */
struct LookStyle {
  const char *name;
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

/* The name of an object at a point. */
struct PictureLabel {
  const char *text;
  struct PicturePoint point;
};

/*
 * Shapes from the back to the front; labels, axes and the scale are for sketches. axes: the directions of x, y and z in
 * the picture, of length 1 or less. pixels: per m; 0 in a drawing without a scale.
 */
struct Drawing {
  struct PictureShape *shapes;
  size_t count;
  struct PictureLabel *labels;
  size_t label_count;
  struct PicturePoint axes[3];
  double pixels;
};

/* Append a polygon, filled or not, and a line; they copy the points. */
void append_shape(struct Drawing *drawing, enum Look look, bool is_filled, const struct PicturePoint *points,
                  size_t count);
void append_line(struct Drawing *drawing, enum Look look, struct PicturePoint from, struct PicturePoint to);

/* Appends a label; it keeps the text. */
void append_label(struct Drawing *drawing, const char *text, struct PicturePoint point);

/* The bounding box of all points; least is greater than most without points. */
struct Rectangle {
  struct PicturePoint least, most;
};

/* Returns the bounding rectangle of all shapes. */
struct Rectangle rectangle_of(const struct Drawing *drawing);

/*
 * Scales and centres the drawing in PICTURE_SIZE pixels, with x to the right and y down, and sets its scale. Returns
 * false if it has no extent.
 */
bool fit_drawing(struct Drawing *drawing);

/* Finds the convex hull; sorts points. Returns its number of points, which come first in hull[2 count]. */
size_t convex_hull(struct PicturePoint *points, size_t count, struct PicturePoint *hull);

#endif
