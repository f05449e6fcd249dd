#include "svg.h"

#include <stdio.h>

#include "base/memory.h"

static void write_shape(FILE *file, const struct PictureShape *shape) {
  const struct LookStyle *style = &looks[shape->look];
  char colour[8];
  snprintf(colour, sizeof colour, "#%02x%02x%02x", style->colour[0], style->colour[1], style->colour[2]);
  if (shape->count == 1) {
    fprintf(file, "<circle fill=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"/>\n", colour, shape->points[0].right,
            shape->points[0].up, style->width / 2.0);
    return;
  }
  if (shape->is_filled) fprintf(file, "<polygon fill=\"%s\" fill-opacity=\"%g\"", colour, style->opacity);
  else fprintf(file, "<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"%g\"", colour, style->width);
  fputs(" points=\"", file);
  for (size_t i = 0; i < shape->count; i++)
    fprintf(file, "%s%.1f,%.1f", i > 0 ? " " : "", shape->points[i].right, shape->points[i].up);
  fputs("\"/>\n", file);
}

char *svg_of(const struct Drawing *drawing) {
  struct TextStream text;
  FILE *file = open_text(&text);
  fprintf(file,
          "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"128\" height=\"128\" viewBox=\"0 0 %d %d\" "
          "stroke-linecap=\"round\">\n",
          PICTURE_SIZE, PICTURE_SIZE);
  for (size_t i = 0; i < drawing->count; i++) write_shape(file, &drawing->shapes[i]);
  fputs("</svg>\n", file);
  return close_text(&text);
}
