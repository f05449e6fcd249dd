#include "sketch.h"

#include <math.h>
#include <stdlib.h>

enum { TRAIL = 400 };

struct Vector {
  double along[3];
};

struct Placed {
  struct Vector position, axes[3];
};

/* Two axes of the picture, and the rectangle that it shows. */
struct View {
  struct Vector right, up;
  double low[2], high[2];
  int size;
};

static const struct Vector origin = {{0.0, 0.0, 0.0}};
static const struct Vector base_axes[3] = {{{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}};

static struct Vector plus(struct Vector a, double factor, struct Vector b) {
  for (int i = 0; i < 3; i++) a.along[i] += factor * b.along[i];
  return a;
}

static double dot(struct Vector a, struct Vector b) {
  return a.along[0] * b.along[0] + a.along[1] * b.along[1] + a.along[2] * b.along[2];
}

static bool read_position(const struct Library *fmu, fmi2Component c, const struct Thing *thing,
                          struct Vector *position) {
  return fmu->get_real(c, thing->position, 3, position->along) == fmi2OK;
}

static bool read_placed(const struct Library *fmu, fmi2Component c, const struct Thing *thing, struct Placed *placed) {
  double turn[9];
  if (!read_position(fmu, c, thing, &placed->position)) return false;
  if (thing->kind != FRAME) return true;
  if (fmu->get_real(c, thing->turn, 9, turn) != fmi2OK) return false;
  for (int axis = 0; axis < 3; axis++)
    placed->axes[axis] = (struct Vector){{turn[axis], turn[3 + axis], turn[6 + axis]}};
  return true;
}

/* The direction of the eye is that in which scripts/animation begins. */
static struct View view_of(const struct Scene *scene, int size) {
  const double azimuth = -1.1, elevation = 0.35;
  struct View view = {.low = {INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY}, .size = size};
  int up = scene->up, first = (up + 1) % 3, second = (up + 2) % 3;
  view.right.along[first] = -sin(azimuth);
  view.right.along[second] = scene->upwards * cos(azimuth);
  view.up.along[first] = -sin(elevation) * cos(azimuth);
  view.up.along[second] = scene->upwards * -sin(elevation) * sin(azimuth);
  view.up.along[up] = scene->upwards * cos(elevation);
  return view;
}

static void include(struct View *view, struct Vector point) {
  const double flat[2] = {dot(point, view->right), dot(point, view->up)};
  for (int i = 0; i < 2; i++) {
    view->low[i] = fmin(view->low[i], flat[i]);
    view->high[i] = fmax(view->high[i], flat[i]);
  }
}

static double extent(const struct View *view) {
  return fmax(view->high[0] - view->low[0], view->high[1] - view->low[1]);
}

static void go_to(cairo_t *cairo, const struct View *view, struct Vector point) {
  double scale = 0.78 * view->size / extent(view), middle = view->size / 2.0;
  double x = dot(point, view->right) - (view->low[0] + view->high[0]) / 2.0;
  double y = dot(point, view->up) - (view->low[1] + view->high[1]) / 2.0;
  cairo_line_to(cairo, middle + scale * x, middle - scale * y);
}

static void draw_line(cairo_t *cairo, const struct View *view, struct Vector from, struct Vector to, double width) {
  go_to(cairo, view, from);
  go_to(cairo, view, to);
  cairo_set_line_width(cairo, width);
  cairo_stroke(cairo);
}

static void draw_axes(cairo_t *cairo, const struct View *view, struct Vector from, const struct Vector *axes,
                      double length, double width) {
  static const double colors[3][3] = {{0.84, 0.16, 0.16}, {0.17, 0.58, 0.28}, {0.11, 0.37, 0.82}};
  for (int axis = 0; axis < 3; axis++) {
    cairo_set_source_rgb(cairo, colors[axis][0], colors[axis][1], colors[axis][2]);
    draw_line(cairo, view, from, plus(from, length, axes[axis]), width);
  }
}

static void draw_dot(cairo_t *cairo, const struct View *view, struct Vector at, double radius) {
  double x, y;
  go_to(cairo, view, at);
  cairo_get_current_point(cairo, &x, &y);
  cairo_new_path(cairo);
  cairo_arc(cairo, x, y, radius, 0.0, 2.0 * M_PI);
  cairo_fill(cairo);
}

/* A body about the origin of its frame: a cube, of which those faces are seen that look at the eye. */
static void draw_cube(cairo_t *cairo, const struct View *view, const struct Placed *frame, double half) {
  struct Vector right = view->right, up = view->up, towards;
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    towards.along[i] = right.along[j] * up.along[k] - right.along[k] * up.along[j];
  }
  static const int corners[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
  for (int axis = 0; axis < 3; axis++) {
    struct Vector normal = frame->axes[axis];
    double side = dot(normal, towards) < 0.0 ? -half : half;
    for (int i = 0; i < 4; i++) {
      struct Vector corner = plus(frame->position, side, normal);
      corner = plus(corner, half * corners[i][0], frame->axes[(axis + 1) % 3]);
      go_to(cairo, view, plus(corner, half * corners[i][1], frame->axes[(axis + 2) % 3]));
    }
    cairo_close_path(cairo);
    double light = 0.75 + 0.25 * fabs(dot(normal, towards));
    cairo_set_source_rgb(cairo, 0.25 * light, 0.55 * light, 0.85 * light);
    cairo_fill_preserve(cairo);
    cairo_set_source_rgb(cairo, 0.1, 0.25, 0.4);
    cairo_set_line_width(cairo, 1.0);
    cairo_stroke(cairo);
  }
}

/* A body is a bar from its frame through its centre of mass, as far again beyond. */
static void draw_body(cairo_t *cairo, const struct View *view, const struct Placed *frame, struct Vector centre) {
  struct Vector lever = plus(centre, -1.0, frame->position);
  if (dot(lever, lever) < 1e-6 * extent(view) * extent(view)) {
    draw_cube(cairo, view, frame, 0.13 * extent(view));
    return;
  }
  struct Vector end = plus(centre, 1.0, lever);
  cairo_set_source_rgb(cairo, 0.1, 0.25, 0.4);
  draw_line(cairo, view, frame->position, end, 8.0);
  cairo_set_source_rgb(cairo, 0.25, 0.55, 0.85);
  draw_line(cairo, view, frame->position, end, 5.5);
}

static void include_body(struct View *view, const struct Placed *frame, struct Vector centre) {
  double half = 0.2 * extent(view);
  include(view, plus(centre, 1.0, plus(centre, -1.0, frame->position)));
  for (int side = -1; side <= 1; side += 2)
    for (int axis = 0; axis < 3; axis++) include(view, plus(centre, side * half, frame->axes[axis]));
}

static const struct Placed *frame_of(const struct Placed *placed, const struct Thing *thing) {
  static const struct Placed base = {.axes = {{{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}}};
  return thing->frame == IN_BASE ? &base : &placed[thing->frame];
}

static void draw_things(cairo_t *cairo, const struct View *view, const struct Scene *scene,
                        const struct Placed *placed) {
  for (int i = 0; i < scene->count; i++) {
    const struct Thing *thing = &scene->things[i];
    if (thing->kind == BODY) draw_body(cairo, view, frame_of(placed, thing), placed[i].position);
    cairo_set_source_rgb(cairo, 0.35, 0.4, 0.46);
    if (thing->kind != BODY && thing->frame != IN_BASE)
      draw_line(cairo, view, frame_of(placed, thing)->position, placed[i].position, 1.5);
  }
  for (int i = 0; i < scene->count; i++) {
    enum ThingKind kind = scene->things[i].kind;
    if (kind == FRAME) draw_axes(cairo, view, placed[i].position, placed[i].axes, 0.14 * extent(view), 1.3);
    cairo_set_source_rgb(cairo, 0.85, 0.25, 0.15);
    if (kind == PARTICLE) draw_dot(cairo, view, placed[i].position, 5.0);
    cairo_set_source_rgb(cairo, 0.2, 0.2, 0.25);
    if (kind == POINT) draw_dot(cairo, view, placed[i].position, 2.5);
  }
}

/* The way of the last thing, until it is so long that it would hide the rest. Returns how many points it has. */
static int follow(const struct Library *fmu, fmi2Component c, const struct Description *description,
                  const struct Thing *last, double limit, struct Vector *trail) {
  double length = 0.0;
  int count = 0;
  while (count < TRAIL && length < limit && read_position(fmu, c, last, &trail[count])) {
    struct Vector way = count > 0 ? plus(trail[count], -1.0, trail[count - 1]) : origin;
    length += sqrt(dot(way, way));
    count++;
    if (!description->has_states || !advance(fmu, c, description, count, description->stop_time / TRAIL)) break;
  }
  return count;
}

bool sketch(cairo_t *cairo, int size, const struct Library *fmu, fmi2Component c, const struct Description *description,
            const struct Scene *scene) {
  struct Placed *placed = calloc((size_t)scene->count, sizeof *placed);
  struct Vector trail[TRAIL];
  struct View view = view_of(scene, size);
  bool right = placed != NULL;
  include(&view, origin);
  for (int i = 0; i < scene->count && right; i++) {
    right = read_placed(fmu, c, &scene->things[i], &placed[i]);
    include(&view, placed[i].position);
  }
  if (right) {
    double length = extent(&view) > 0.0 ? extent(&view) : 1.0;
    int count = follow(fmu, c, description, &scene->things[scene->count - 1], 4.0 * length, trail);
    for (int i = 0; i < count; i++) include(&view, trail[i]);
    for (int axis = 0; axis < 3; axis++) include(&view, plus(origin, 0.2 * length, base_axes[axis]));
    for (int i = 0; i < scene->count; i++)
      if (scene->things[i].kind == BODY) include_body(&view, frame_of(placed, &scene->things[i]), placed[i].position);
    cairo_set_line_cap(cairo, CAIRO_LINE_CAP_ROUND);
    draw_axes(cairo, &view, origin, base_axes, 0.25 * extent(&view), 0.7);
    cairo_set_source_rgb(cairo, 0.35, 0.6, 0.85);
    cairo_set_line_width(cairo, 1.0);
    for (int i = 0; i < count; i++) go_to(cairo, &view, trail[i]);
    cairo_stroke(cairo);
    draw_things(cairo, &view, scene, placed);
  }
  free(placed);
  return right;
}
