#include "svg.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "xml_output.h"

static void write_position(xmlTextWriterPtr writer, const char *name, double pixels) {
  xmlTextWriterWriteFormatAttribute(writer, BAD_CAST name, "%.1f", pixels);
}

static void write_points(xmlTextWriterPtr writer, const struct PictureShape *shape) {
  struct TextStream text;
  FILE *stream = open_text(&text);
  for (size_t i = 0; i < shape->count; i++)
    fprintf(stream, "%s%.1f,%.1f", i > 0 ? " " : "", shape->points[i].right, shape->points[i].up);
  write_attribute(writer, "points", close_text(&text));
}

static void write_shape(xmlTextWriterPtr writer, const struct PictureShape *shape) {
  const struct LookStyle *style = &looks[shape->look];
  bool is_dot = shape->count == 1;
  xmlTextWriterStartElement(writer, BAD_CAST(is_dot ? "circle" : shape->is_filled ? "polygon" : "polyline"));
  write_attribute(writer, "class", style->name);
  if (is_dot) {
    write_position(writer, "cx", shape->points[0].right);
    write_position(writer, "cy", shape->points[0].up);
    write_position(writer, "r", style->width / 2.0);
  } else {
    write_points(writer, shape);
    write_number(writer, shape->is_filled ? "fill-opacity" : "stroke-width",
                 shape->is_filled ? style->opacity : style->width);
  }
  xmlTextWriterEndElement(writer);
}

static void write_style(xmlTextWriterPtr writer) {
  xmlTextWriterStartElement(writer, BAD_CAST "style");
  xmlTextWriterWriteString(writer, BAD_CAST "circle, polygon { fill: currentColor } "
                                            "polyline { fill: none; stroke: currentColor; stroke-linecap: round }");
  for (int i = 0; i < LOOK_COUNT; i++) {
    int first = 0;
    while (strcmp(looks[first].name, looks[i].name) != 0) first++;
    if (first < i) continue; /* looks of one class share its colour */
    xmlTextWriterWriteFormatString(writer, " .%s { color: #%02x%02x%02x }", looks[i].name, looks[i].colour[0],
                                   looks[i].colour[1], looks[i].colour[2]);
  }
  xmlTextWriterEndElement(writer);
}

/* Writes the part between top and bottom, after the attributes of <svg>. */
static void write_drawing(xmlTextWriterPtr writer, const struct Drawing *drawing, double top, double bottom,
                          bool with_style) {
  xmlTextWriterWriteFormatAttribute(writer, BAD_CAST "viewBox", "0 %.1f %d %.1f", top, PICTURE_SIZE, bottom - top);
  if (with_style) write_style(writer);
  for (size_t i = 0; i < drawing->count; i++) write_shape(writer, &drawing->shapes[i]);
}

static void write_text(xmlTextWriterPtr writer, struct PicturePoint at, const char *text) {
  xmlTextWriterStartElement(writer, BAD_CAST "text");
  write_position(writer, "x", at.right);
  write_position(writer, "y", at.up);
  xmlTextWriterWriteString(writer, BAD_CAST text);
  xmlTextWriterEndElement(writer);
}

/* Writes a line without a class, in pixels. */
static void write_line(xmlTextWriterPtr writer, double right, double down, double along, double up) {
  xmlTextWriterStartElement(writer, BAD_CAST "path");
  xmlTextWriterWriteFormatAttribute(writer, BAD_CAST "d", "M%.1f %.1fl%.1f %.1f", right, down, along, -up);
  xmlTextWriterEndElement(writer);
}

/* Returns 1, 2 or 5 times a power of ten, the longest of these lengths, in m, that is at most 50 pixels in the picture. */
static double scale_of(double pixels) {
  double limit = 50.0 / pixels, power = pow(10.0, floor(log10(limit)));
  return limit >= 5.0 * power ? 5.0 * power : limit >= 2.0 * power ? 2.0 * power : power;
}

/* True if no earlier label would be under this one. */
static bool is_legible(const struct Drawing *drawing, size_t label) {
  const double width = 30.0, height = 7.0; /* pixels of a label of 8 letters */
  bool is_free = true;
  for (size_t i = 0; i < label; i++) {
    struct PicturePoint one = drawing->labels[i].point, other = drawing->labels[label].point;
    is_free &= fabs(one.right - other.right) > width || fabs(one.up - other.up) > height;
  }
  return is_free;
}

/* Writes the names of bodies, and below the drawing the axes and the scale. */
static void write_notes(xmlTextWriterPtr writer, const struct Drawing *drawing, double below) {
  const double axis = 12.0, margin = 14.0; /* pixels: the length of an axis, and the distance from the picture's edge */
  char text[32];
  double scale = scale_of(drawing->pixels), length = scale * drawing->pixels;
  xmlTextWriterStartElement(writer, BAD_CAST "g");
  write_attribute(writer, "class", "notes");
  for (size_t i = 0; i < drawing->label_count; i++) {
    struct PicturePoint at = drawing->labels[i].point;
    if (is_legible(drawing, i))
      write_text(writer, (struct PicturePoint){at.right + 6.0, at.up - 5.0}, drawing->labels[i].text);
  }
  for (int i = 0; i < 3; i++) {
    struct PicturePoint to = drawing->axes[i];
    if (hypot(to.right, to.up) < 0.1) continue;
    write_line(writer, margin, below, axis * to.right, axis * to.up);
    write_text(writer, (struct PicturePoint){margin + 1.5 * axis * to.right - 2.0, below - 1.5 * axis * to.up + 2.0},
               (const char *[]){"x", "y", "z"}[i]);
  }
  write_line(writer, PICTURE_SIZE - margin - length, below, length, 0.0);
  snprintf(text, sizeof text, "%g m", scale);
  write_text(writer, (struct PicturePoint){PICTURE_SIZE - margin - length, below - 3.0}, text);
  xmlTextWriterEndElement(writer);
}

void write_sketch(xmlTextWriterPtr writer, const struct Drawing *drawing) {
  const double room = 8.0; /* margin for dots and lines, which are wider than their points */
  const double foot = drawing->pixels > 0.0 ? 34.0 : 0.0; /* for the axes and the scale */
  struct Rectangle all = rectangle_of(drawing);
  xmlTextWriterStartElement(writer, BAD_CAST "svg");
  write_attribute(writer, "class", "sketch");
  write_attribute(writer, "role", "img");
  write_attribute(writer, "aria-label", "the system at its start values");
  write_drawing(writer, drawing, all.least.up - room, all.most.up + room + foot, false);
  if (foot > 0.0) write_notes(writer, drawing, all.most.up + room + foot - 10.0);
  xmlTextWriterEndElement(writer);
}

bool write_icon(xmlBufferPtr buffer, const struct Drawing *drawing) {
  xmlTextWriterPtr writer = open_document(buffer, "svg");
  if (writer == NULL) return false;
  write_attribute(writer, "xmlns", "http://www.w3.org/2000/svg");
  write_attribute(writer, "width", "128");
  write_attribute(writer, "height", "128");
  write_drawing(writer, drawing, 0.0, PICTURE_SIZE, true);
  return close_document(writer);
}
