/*
 * Draws an FMU's model.png from a run of the FMU itself: a sketch of a system with frames; of others, the phase portrait of
 * the first coordinate, or without coordinates the first output over the first input.
 * Usage: icon LIBRARY modelDescription.xml model.png
 */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include <cairo.h>

#include "description.h"
#include "library.h"
#include "scene.h"
#include "sketch.h"

enum { SIZE = 128, MARGIN = 12, POINTS = 1500 };

struct Curve {
  double x[POINTS + 1], y[POINTS + 1];
  int count;
};

static void append(struct Curve *curve, double x, double y) {
  curve->x[curve->count] = x;
  curve->y[curve->count++] = y;
}

/* Runs the FMU to the end; where it stops early or becomes too slow, the portrait ends there. */
static struct Curve run(const struct Library *fmu, fmi2Component c, const struct Description *description, double end) {
  struct Curve curve = {.count = 0};
  double values[2], step = end / POINTS;
  for (int i = 0; i <= POINTS; i++) {
    if (description->has_states) {
      if (i > 0 && !advance(fmu, c, description, i, step)) break;
      if (fmu->get_real(c, description->shown, 2, values) != fmi2OK) break;
    } else {
      values[0] = 10.0 * (2.0 * i / POINTS - 1.0);
      if (fmu->set_real(c, &description->shown[0], 1, &values[0]) != fmi2OK ||
          fmu->get_real(c, &description->shown[1], 1, &values[1]) != fmi2OK)
        break;
    }
    append(&curve, values[0], values[1]);
  }
  return curve;
}

struct Range {
  double low, high;
};

/* The range of the values, with 0 in it unless that is far away. */
static struct Range range_of(const double *values, int count) {
  struct Range range = {values[0], values[0]};
  for (int i = 1; i < count; i++) {
    range.low = fmin(range.low, values[i]);
    range.high = fmax(range.high, values[i]);
  }
  double width = range.high - range.low;
  if (width <= 0.0) return (struct Range){range.low - 1.0, range.high + 1.0};
  if (range.low > 0.0 && range.low < width) range.low = 0.0;
  if (range.high < 0.0 && -range.high < width) range.high = 0.0;
  return range;
}

static bool contains_zero(struct Range range) {
  return range.low <= 0.0 && range.high >= 0.0;
}

static double place(struct Range range, double value) {
  return MARGIN + (SIZE - 2 * MARGIN) * (value - range.low) / (range.high - range.low);
}

/* The length of the curve as it is drawn, in widths of the picture. */
static double drawn_length(const struct Curve *curve) {
  if (curve->count == 0) return 0.0;
  struct Range x = range_of(curve->x, curve->count), y = range_of(curve->y, curve->count);
  double length = 0.0;
  for (int i = 1; i < curve->count; i++)
    length +=
        hypot((curve->x[i] - curve->x[i - 1]) / (x.high - x.low), (curve->y[i] - curve->y[i - 1]) / (y.high - y.low));
  return length;
}

/* The run, or so much of its beginning that the curve is no block of lines, as that of a fast top would be. */
static struct Curve portrait(const struct Library *fmu, fmi2Component c, const struct Description *description) {
  enum { LENGTH_LIMIT = 25, HALVINGS = 20 };
  struct Curve curve = {.count = 0};
  double end = description->stop_time;
  if (!start(fmu, c)) return curve;
  curve = run(fmu, c, description, end);
  for (int i = 0; i < HALVINGS && drawn_length(&curve) > LENGTH_LIMIT; i++) {
    if (fmu->reset(c) != fmi2OK || !start(fmu, c)) break;
    end *= 0.5;
    curve = run(fmu, c, description, end);
  }
  return curve;
}

static void draw_axes(cairo_t *cairo, struct Range x, struct Range y) {
  cairo_set_source_rgb(cairo, 0.75, 0.78, 0.82);
  cairo_set_line_width(cairo, 1.0);
  if (contains_zero(y)) {
    cairo_move_to(cairo, MARGIN / 2.0, SIZE - place(y, 0.0));
    cairo_line_to(cairo, SIZE - MARGIN / 2.0, SIZE - place(y, 0.0));
  }
  if (contains_zero(x)) {
    cairo_move_to(cairo, place(x, 0.0), MARGIN / 2.0);
    cairo_line_to(cairo, place(x, 0.0), SIZE - MARGIN / 2.0);
  }
  cairo_stroke(cairo);
}

static void draw_curve(cairo_t *cairo, const struct Curve *curve, struct Range x, struct Range y) {
  cairo_set_source_rgb(cairo, 0.05, 0.35, 0.65);
  cairo_set_line_width(cairo, 1.5);
  cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
  for (int i = 0; i < curve->count; i++) cairo_line_to(cairo, place(x, curve->x[i]), SIZE - place(y, curve->y[i]));
  cairo_stroke(cairo);
  cairo_set_source_rgb(cairo, 0.85, 0.25, 0.15);
  cairo_arc(cairo, place(x, curve->x[0]), SIZE - place(y, curve->y[0]), 3.5, 0.0, 2.0 * M_PI);
  cairo_fill(cairo);
}

static void draw_portrait(cairo_t *cairo, const struct Library *fmu, fmi2Component c,
                          const struct Description *description) {
  struct Curve curve = portrait(fmu, c, description);
  /* A system that cannot start gets a portrait of a point. */
  if (curve.count == 0) append(&curve, 0.0, 0.0);
  struct Range x = range_of(curve.x, curve.count), y = range_of(curve.y, curve.count);
  draw_axes(cairo, x, y);
  draw_curve(cairo, &curve, x, y);
}

static bool draw(const struct Library *fmu, fmi2Component c, const struct Description *description,
                 const struct Scene *scene, const char *path) {
  cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, SIZE, SIZE);
  cairo_t *cairo = cairo_create(surface);
  cairo_set_source_rgb(cairo, 1.0, 1.0, 1.0);
  cairo_paint(cairo);
  bool has_scene = scene->count > 0,
       sketched = has_scene && start(fmu, c) && sketch(cairo, SIZE, fmu, c, description, scene);
  if (has_scene && !sketched) fmu->reset(c);
  if (!sketched) draw_portrait(cairo, fmu, c, description);
  cairo_status_t status = cairo_surface_write_to_png(surface, path);
  if (status != CAIRO_STATUS_SUCCESS) fprintf(stderr, "icon: %s: %s\n", path, cairo_status_to_string(status));
  cairo_destroy(cairo);
  cairo_surface_destroy(surface);
  return status == CAIRO_STATUS_SUCCESS;
}

int main(int count, char **words) {
  struct Description description;
  struct Library fmu;
  struct Scene scene;
  if (count != 4) {
    fputs("usage: icon LIBRARY modelDescription.xml model.png\n", stderr);
    return 1;
  }
  if (!description_read(words[2], &description) || !scene_read(words[2], &scene) || !library_load(words[1], &fmu))
    return 1;
  const fmi2CallbackFunctions callbacks = {NULL, calloc, free, NULL, NULL};
  fmi2Component c = fmu.instantiate("icon", fmi2CoSimulation, description.guid, NULL, &callbacks, fmi2False, fmi2False);
  bool drawn = c != NULL && draw(&fmu, c, &description, &scene, words[3]);
  if (c != NULL) fmu.free_instance(c);
  scene_free(&scene);
  description_free(&description);
  if (c == NULL) fputs("icon: the FMU cannot be instantiated\n", stderr);
  return drawn ? 0 : 1;
}
