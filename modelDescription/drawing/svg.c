#include "svg.h"

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

void write_sketch(xmlTextWriterPtr writer, const struct Drawing *drawing) {
  const double room = 8.0; /* margin for dots and lines, which are wider than their points */
  struct Rectangle all = rectangle_of(drawing);
  xmlTextWriterStartElement(writer, BAD_CAST "svg");
  write_attribute(writer, "class", "sketch");
  write_attribute(writer, "role", "img");
  write_attribute(writer, "aria-label", "the system at its start values");
  write_drawing(writer, drawing, all.least.up - room, all.most.up + room, false);
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
