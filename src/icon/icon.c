/*
 * Draws an FMU's model.png: the phase portrait of its first coordinate, from a run of the FMU itself; without
 * coordinates, its first output over its first input. Usage: icon LIBRARY modelDescription.xml model.png
 */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cairo.h>
#include <dlfcn.h>

#include "description.h"
#include "fmi2.h"

enum { SIZE = 128, MARGIN = 12, POINTS = 1500 };

struct Curve {
  double x[POINTS + 1], y[POINTS + 1];
  int count;
};

/* The functions of the FMU that a run needs. */
struct Library {
  __typeof__(fmi2Instantiate) *instantiate;
  __typeof__(fmi2SetupExperiment) *setup_experiment;
  __typeof__(fmi2EnterInitializationMode) *enter_initialization_mode;
  __typeof__(fmi2ExitInitializationMode) *exit_initialization_mode;
  __typeof__(fmi2SetReal) *set_real;
  __typeof__(fmi2GetReal) *get_real;
  __typeof__(fmi2GetInteger) *get_integer;
  __typeof__(fmi2DoStep) *do_step;
  __typeof__(fmi2Reset) *reset;
  __typeof__(fmi2FreeInstance) *free_instance;
};

static bool load(const char *path, struct Library *library) {
  struct {
    const char *name;
    void *target;
  } functions[] = {
      {"fmi2Instantiate", &library->instantiate},
      {"fmi2SetupExperiment", &library->setup_experiment},
      {"fmi2EnterInitializationMode", &library->enter_initialization_mode},
      {"fmi2ExitInitializationMode", &library->exit_initialization_mode},
      {"fmi2SetReal", &library->set_real},
      {"fmi2GetReal", &library->get_real},
      {"fmi2GetInteger", &library->get_integer},
      {"fmi2DoStep", &library->do_step},
      {"fmi2Reset", &library->reset},
      {"fmi2FreeInstance", &library->free_instance},
  };
  void *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (handle == NULL) fprintf(stderr, "icon: %s\n", dlerror());
  for (size_t i = 0; i < sizeof functions / sizeof *functions && handle != NULL; i++) {
    void *function = dlsym(handle, functions[i].name);
    memcpy(functions[i].target, &function, sizeof function);
  }
  return handle != NULL;
}

static void append(struct Curve *curve, double x, double y) {
  curve->x[curve->count] = x;
  curve->y[curve->count++] = y;
}

/* A step of the FMU. False where it fails, or where the solver has taken too many steps, as for a stiff system. */
static bool advance(const struct Library *fmu, fmi2Component c, const struct Description *description, double from,
                    double to) {
  /* The work of a step grows as the states do, or as their square. */
  double limit = fmin(200000.0, fmax(300.0, 4e6 / (description->states * description->states)));
  fmi2Integer steps = 0;
  return fmu->do_step(c, from, to - from, fmi2True) == fmi2OK &&
         fmu->get_integer(c, &description->solver_steps, 1, &steps) == fmi2OK && steps <= limit;
}

/* The first step, in parts that double from a tiny one: the work for a part tells that for the next. */
static bool begin(const struct Library *fmu, fmi2Component c, const struct Description *description, double end) {
  enum { HALVINGS = 24 };
  double from = 0.0;
  for (int i = HALVINGS; i >= 0; i--) {
    double to = ldexp(end, -i);
    if (!advance(fmu, c, description, from, to)) return false;
    from = to;
  }
  return true;
}

/* Runs the FMU to the end; where it stops early or becomes too slow, the portrait ends there. */
static struct Curve run(const struct Library *fmu, fmi2Component c, const struct Description *description, double end) {
  struct Curve curve = {.count = 0};
  double values[2], step = end / POINTS;
  for (int i = 0; i <= POINTS; i++) {
    if (description->has_states) {
      if (i == 1 && !begin(fmu, c, description, step)) break;
      if (i > 1 && !advance(fmu, c, description, (i - 1) * step, i * step)) break;
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

/* Brings a new or reset instance to its start. False where the system cannot start at its start values. */
static bool start(const struct Library *fmu, fmi2Component c) {
  return fmu->setup_experiment(c, fmi2True, 1e-5, 0.0, fmi2False, 0.0) == fmi2OK &&
         fmu->enter_initialization_mode(c) == fmi2OK && fmu->exit_initialization_mode(c) == fmi2OK;
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

static bool draw(const struct Curve *curve, const char *path) {
  cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, SIZE, SIZE);
  cairo_t *cairo = cairo_create(surface);
  struct Range x = range_of(curve->x, curve->count), y = range_of(curve->y, curve->count);
  cairo_set_source_rgb(cairo, 1.0, 1.0, 1.0);
  cairo_paint(cairo);
  draw_axes(cairo, x, y);
  draw_curve(cairo, curve, x, y);
  cairo_status_t status = cairo_surface_write_to_png(surface, path);
  if (status != CAIRO_STATUS_SUCCESS) fprintf(stderr, "icon: %s: %s\n", path, cairo_status_to_string(status));
  cairo_destroy(cairo);
  cairo_surface_destroy(surface);
  return status == CAIRO_STATUS_SUCCESS;
}

int main(int count, char **words) {
  struct Description description;
  struct Library fmu;
  if (count != 4) {
    fputs("usage: icon LIBRARY modelDescription.xml model.png\n", stderr);
    return 1;
  }
  if (!description_read(words[2], &description) || !load(words[1], &fmu)) return 1;
  const fmi2CallbackFunctions callbacks = {NULL, calloc, free, NULL, NULL};
  fmi2Component c = fmu.instantiate("icon", fmi2CoSimulation, description.guid, NULL, &callbacks, fmi2False, fmi2False);
  struct Curve curve = {.count = 0};
  if (c != NULL) curve = portrait(&fmu, c, &description);
  /* A system that cannot start gets a portrait of a point. */
  if (curve.count == 0) append(&curve, 0.0, 0.0);
  if (c != NULL) fmu.free_instance(c);
  description_free(&description);
  if (c == NULL) fputs("icon: the FMU cannot be instantiated\n", stderr);
  return c != NULL && draw(&curve, words[3]) ? 0 : 1;
}
