#include "flange_drawing.h"

/* Sines of multiples of 15 degrees, as constants so that all platforms round alike. The circle is a polygon. */
static const double sines[] = {
    0.0, 0.25881904510252074, 0.5, 0.70710678118654757, 0.86602540378443860, 0.96592582628906831, 1.0};
/* Corners of a quarter of the circle, and of the whole. */
enum { QUARTER = 6, CORNERS = 4 * QUARTER };

static double sine(int corner) {
  int quarter = corner / QUARTER % 4, rest = corner % QUARTER;
  double value = quarter % 2 == 0 ? sines[rest] : sines[QUARTER - rest];
  return quarter < 2 ? value : -value;
}

struct Drawing flange_drawing(void) {
  static const double centre = PICTURE_SIZE / 2.0, radius = 0.46 * PICTURE_SIZE;
  struct Drawing drawing = {0};
  struct PicturePoint points[CORNERS + 1];
  for (int i = 0; i <= CORNERS; i++)
    points[i] = (struct PicturePoint){centre + radius * sine(i + QUARTER), centre + radius * sine(i)};
  append_shape(&drawing, SOLID, true, points, CORNERS);
  append_shape(&drawing, SIGNAL, false, points, CORNERS + 1);
  return drawing;
}
