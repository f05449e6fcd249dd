#include "sketch.h"

#include <math.h>

#include "drawn_points.h"
#include "xml_output.h"

/* In pixels. */
static const double size = 260.0, margin = 30.0;

/* From the system's units to pixels. */
struct Scale {
  double left, low, pixels; /* the smallest of what is drawn, and pixels for a unit */
  double right_shift, up_shift;
};

struct Extent {
  double least[2], most[2];
};

static void include(struct Extent *extent, double right, double up) {
  const double at[] = {right, up};
  for (int i = 0; i < 2; i++) {
    extent->least[i] = fmin(extent->least[i], at[i]);
    extent->most[i] = fmax(extent->most[i], at[i]);
  }
}

static struct Extent extent_of(const struct Drawing *drawing) {
  struct Extent extent = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
  for (size_t i = 0; i < drawing->count; i++) {
    const struct DrawnPoint *point = &drawing->points[i];
    include(&extent, point->right - point->half_right, point->up - point->half_up);
    include(&extent, point->right + point->half_right, point->up + point->half_up);
  }
  return extent;
}

/* All of it in the middle of the picture. */
static struct Scale scale_for(struct Extent extent) {
  double width = extent.most[0] - extent.least[0], height = extent.most[1] - extent.least[1];
  double pixels = (size - 2.0 * margin) / fmax(width, height);
  return (struct Scale){extent.least[0], extent.least[1], pixels, (size - pixels * width) / 2.0,
                        (size - pixels * height) / 2.0};
}

static void write_place(xmlTextWriterPtr writer, const char *name, double pixels) {
  xmlTextWriterWriteFormatAttribute(writer, BAD_CAST name, "%.1f", pixels);
}

static double across(const struct Scale *scale, double right) {
  return scale->right_shift + scale->pixels * (right - scale->left);
}

static double down(const struct Scale *scale, double up) {
  return size - scale->up_shift - scale->pixels * (up - scale->low);
}

static void write_line(xmlTextWriterPtr writer, const struct Scale *scale, const char *class, const double from[2],
                       const double to[2]) {
  xmlTextWriterStartElement(writer, BAD_CAST "line");
  write_attribute(writer, "class", class);
  write_place(writer, "x1", across(scale, from[0]));
  write_place(writer, "y1", down(scale, from[1]));
  write_place(writer, "x2", across(scale, to[0]));
  write_place(writer, "y2", down(scale, to[1]));
  xmlTextWriterEndElement(writer);
}

static void write_point(xmlTextWriterPtr writer, const struct Scale *scale, const struct DrawnPoint *point) {
  static const struct {
    const char *class;
    double radius;
  } looks[] = {[ORIGIN] = {"base", 4.0},
               [FRAME_POINT] = {"frame", 3.0},
               [PARTICLE_POINT] = {"particle", 7.0},
               [BODY_POINT] = {"middle", 2.5},
               [MERE_POINT] = {"frame", 2.5}};
  const double ends[2][2] = {{point->right - point->half_right, point->up - point->half_up},
                             {point->right + point->half_right, point->up + point->half_up}};
  if (point->kind == BODY_POINT) write_line(writer, scale, "body", ends[0], ends[1]);
  xmlTextWriterStartElement(writer, BAD_CAST "circle");
  write_attribute(writer, "class", looks[point->kind].class);
  write_place(writer, "cx", across(scale, point->right));
  write_place(writer, "cy", down(scale, point->up));
  write_place(writer, "r", looks[point->kind].radius);
  xmlTextWriterEndElement(writer);
}

static void write_drawing(xmlTextWriterPtr writer, const struct Drawing *drawing, const struct Scale *scale) {
  xmlTextWriterStartElement(writer, BAD_CAST "svg");
  write_attribute(writer, "class", "sketch");
  xmlTextWriterWriteFormatAttribute(writer, BAD_CAST "viewBox", "0 0 %g %g", size, size);
  write_attribute(writer, "role", "img");
  write_attribute(writer, "aria-label", "the system at its start values");
  for (size_t i = 0; i < drawing->link_count; i++) {
    const struct DrawnPoint *from = &drawing->points[drawing->links[i].from],
                            *to = &drawing->points[drawing->links[i].to];
    write_line(writer, scale, "link", (double[]){from->right, from->up}, (double[]){to->right, to->up});
  }
  for (size_t i = 0; i < drawing->count; i++) write_point(writer, scale, &drawing->points[i]);
  xmlTextWriterEndElement(writer);
}

void write_sketch(const struct Page *page) {
  struct Drawing drawing = drawing_of(page->model);
  struct Extent extent = extent_of(&drawing);
  double width = fmax(extent.most[0] - extent.least[0], extent.most[1] - extent.least[1]);
  if (drawing.count > 1 && isnormal(width)) {
    struct Scale scale = scale_for(extent);
    write_drawing(page->writer, &drawing, &scale);
  }
}
