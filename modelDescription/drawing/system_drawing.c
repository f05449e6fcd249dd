#include "system_drawing.h"

#include <math.h>

#include "solids.h"
#include "surfaces.h"

enum { MOST_WAYS = 8, MOST_DOTS = 60 };

/* In the plane x to the right and y upwards; in space from above and aside, where gravity points down. */
static struct View view_of(const struct Model *model, const struct Things *things) {
  const double azimuth = -1.1, elevation = 0.35;
  struct View view = {{1, 0, 0}, {0, 1, 0}};
  int up = 2;
  for (int axis = 0; axis < 3; axis++)
    if (model->mechanism.gravity.along[axis] != ZERO) up = axis;
  if (!things->are_in_space) return view;
  int first = (up + 1) % 3, second = (up + 2) % 3;
  view.right[up] = 0.0;
  view.right[first] = -sin(azimuth);
  view.right[second] = cos(azimuth);
  view.up[up] = cos(elevation);
  view.up[first] = -sin(elevation) * cos(azimuth);
  view.up[second] = -sin(elevation) * sin(azimuth);
  return view;
}

static struct Spot spot_of(const struct View *view, const struct Thing *thing, const double *values) {
  return seen(view, (double[]){values[thing->position[0]], values[thing->position[1]], values[thing->position[2]]});
}

/* A uniform bar of mass m and length l has the moment of inertia m l^2/12. */
static void append_bar(struct Drawing *drawing, const struct Body *body, struct Spot middle, const double *values) {
  double half = sqrt(3.0 * values[body->inertia.node] / values[body->mass.node]), angle = values[body->angle.node];
  double right = half * cos(angle), up = half * sin(angle);
  if (isfinite(right) && isfinite(up))
    append_line(drawing, BAR, (struct Spot){middle.right - right, middle.up - up},
                (struct Spot){middle.right + right, middle.up + up});
}

/* Where the surface would be met from a spot. */
static struct Spot foot_of(const struct Surface *surface, struct Spot spot) {
  double height =
      (spot.right - surface->place[0]) * surface->normal[0] + (spot.up - surface->place[1]) * surface->normal[1];
  return (struct Spot){spot.right - height * surface->normal[0], spot.up - height * surface->normal[1]};
}

/* A line with hatches behind it, as long as what stands on it, or as a stop. */
static void append_surface(struct Drawing *drawing, const struct Surface *surface, double size) {
  enum { HATCHES = 12 };
  double half = surface->is_stop ? 0.12 * size : 0.4 * size;
  double along[2] = {surface->normal[1], -surface->normal[0]}, low = -half, high = half;
  for (size_t i = 0; i < drawing->count && !surface->is_stop; i++)
    for (size_t j = 0; j < drawing->shapes[i].count; j++) {
      struct Spot foot = foot_of(surface, drawing->shapes[i].points[j]);
      double place = (foot.right - surface->place[0]) * along[0] + (foot.up - surface->place[1]) * along[1];
      low = fmin(low, place - 0.12 * size);
      high = fmax(high, place + 0.12 * size);
    }
  double depth = 0.05 * size;
  int hatches = surface->is_stop ? HATCHES / 3 : HATCHES;
  for (int i = 0; i <= hatches; i++) {
    double place = low + (high - low) * i / hatches;
    struct Spot at = {surface->place[0] + place * along[0], surface->place[1] + place * along[1]};
    struct Spot behind = {at.right - depth * (surface->normal[0] + along[0]),
                          at.up - depth * (surface->normal[1] + along[1])};
    append_line(drawing, GROUND, at, behind);
  }
  append_line(drawing, GROUND, (struct Spot){surface->place[0] + low * along[0], surface->place[1] + low * along[1]},
              (struct Spot){surface->place[0] + high * along[0], surface->place[1] + high * along[1]});
}

/* A piece of a plane in space, about its place. */
static void append_plane(struct Drawing *drawing, const struct View *view, const struct Surface *surface, double size) {
  double first[3] = {0.0, 0.0, 0.0}, second[3], corner[3];
  struct Spot corners[5];
  int least = 0;
  for (int i = 1; i < 3; i++)
    if (fabs(surface->normal[i]) < fabs(surface->normal[least])) least = i;
  first[(least + 1) % 3] = surface->normal[(least + 2) % 3];
  first[(least + 2) % 3] = -surface->normal[(least + 1) % 3];
  double length = hypot(hypot(first[0], first[1]), first[2]), half = surface->is_stop ? 0.12 * size : 0.4 * size;
  for (int i = 0; i < 3; i++) first[i] /= length;
  for (int i = 0; i < 3; i++)
    second[i] = surface->normal[(i + 1) % 3] * first[(i + 2) % 3] - surface->normal[(i + 2) % 3] * first[(i + 1) % 3];
  for (int k = 0; k < 5; k++) {
    double a = k == 1 || k == 2 ? half : -half, b = k == 2 || k == 3 ? half : -half;
    for (int i = 0; i < 3; i++) corner[i] = surface->place[i] + a * first[i] + b * second[i];
    corners[k] = seen(view, corner);
  }
  append_shape(drawing, GROUND, true, corners, 4);
  append_shape(drawing, GROUND, false, corners, 5);
}

/* The directions of the base, and the way from the origin to what no rod holds. */
static void append_axes(struct Drawing *drawing, const struct View *view, const struct Things *things,
                        const struct Links *links, const double *values, double size) {
  struct Spot origin = {0.0, 0.0};
  for (int axis = 0; axis < (things->are_in_space ? 3 : 2); axis++) {
    double tip[3] = {0.0, 0.0, 0.0};
    tip[axis] = 0.3 * size;
    append_line(drawing, AXIS, origin, seen(view, tip));
  }
  for (size_t i = 1; i < things->count && things->count <= MOST_WAYS; i++) {
    bool is_held = things->items[i].kind != PARTICLE_POINT && things->items[i].kind != MERE_POINT;
    for (size_t k = 0; k < links->count; k++) is_held |= links->items[k].from == i || links->items[k].to == i;
    if (!is_held) append_line(drawing, AXIS, origin, spot_of(view, &things->items[i], values));
  }
}

/* What is behind the points: solids, rods and bars. */
static void append_bodies(struct Drawing *drawing, const struct View *view, const struct Things *things,
                          const struct Links *links, const struct Model *model, const double *values) {
  for (size_t i = 0; i < things->count; i++)
    if (things->items[i].kind == SOLID_POINT) append_solid(drawing, view, model, things->items[i].body, values);
  for (size_t i = 0; i < links->count; i++)
    append_line(drawing, LINK, spot_of(view, &things->items[links->items[i].from], values),
                spot_of(view, &things->items[links->items[i].to], values));
  for (size_t i = 0; i < things->count; i++)
    if (things->items[i].kind == BODY_POINT)
      append_bar(drawing, things->items[i].body, spot_of(view, &things->items[i], values), values);
}

/* The origin last, since it is what the rest hangs on. */
static void append_points(struct Drawing *drawing, const struct View *view, const struct Things *things,
                          const double *values) {
  static const enum Look look[] = {[ORIGIN] = BASE,     [FRAME_POINT] = JOINT, [PARTICLE_POINT] = PARTICLE,
                                   [BODY_POINT] = HOLE, [SOLID_POINT] = JOINT, [MERE_POINT] = JOINT};
  for (size_t i = things->count; i-- > 0;) {
    struct Spot spot = spot_of(view, &things->items[i], values);
    bool is_small = things->items[i].kind == PARTICLE_POINT && things->count > MOST_DOTS;
    append_shape(drawing, is_small ? JOINT : look[things->items[i].kind], true, &spot, 1);
    if (things->items[i].kind == ORIGIN) append_shape(drawing, HOLE, true, &spot, 1);
  }
}

static void append_drawing(struct Drawing *drawing, const struct Drawing *other) {
  for (size_t i = 0; i < other->count; i++) {
    const struct Shape *shape = &other->shapes[i];
    append_shape(drawing, shape->look, shape->is_filled, shape->points, shape->count);
  }
}

static bool is_finite(const struct Rectangle *all) {
  return isfinite(all->least.right) && isfinite(all->least.up) && isfinite(all->most.right) && isfinite(all->most.up);
}

static bool draw_mechanism(struct Drawing *drawing, const struct Model *model, const struct Equations *equations) {
  struct Things things = things_of(model);
  double *values = values_at(model, equations, NULL);
  struct Drawing seen_things = {.count = 0};
  if (values == NULL) values = graph_evaluate(model->graph, start_values(model));
  struct View view = view_of(model, &things);
  struct Links links = links_of(model, equations, &things, values);
  append_bodies(&seen_things, &view, &things, &links, model, values);
  append_points(&seen_things, &view, &things, values);
  struct Rectangle all = rectangle_of(&seen_things);
  double size = fmax(all.most.right - all.least.right, all.most.up - all.least.up);
  if (things.count < 2 || !is_finite(&all)) return false;
  struct Surfaces surfaces = surfaces_of(model, equations, &things);
  for (size_t i = 0; i < surfaces.count; i++)
    if (things.are_in_space) append_plane(&seen_things, &view, &surfaces.items[i], size);
    else append_surface(&seen_things, &surfaces.items[i], size);
  append_axes(drawing, &view, &things, &links, values, size);
  append_drawing(drawing, &seen_things);
  return fit_drawing(drawing);
}

/* Arrows to the block or away from it, one a variable as far as they can be told apart. */
static void append_signals(struct Drawing *drawing, size_t count, double from) {
  enum { MOST_SIGNALS = 6 };
  size_t shown = count < MOST_SIGNALS ? count : MOST_SIGNALS;
  for (size_t i = 0; i < shown; i++) {
    double up = 1.0 - 2.0 * ((double)i + 0.5) / (double)shown, tip = from + 0.7;
    append_line(drawing, SIGNAL, (struct Spot){from, up}, (struct Spot){tip, up});
    append_shape(drawing, SIGNAL, false, (struct Spot[]){{tip - 0.14, up + 0.1}, {tip, up}, {tip - 0.14, up - 0.1}}, 3);
  }
}

static void draw_block(struct Drawing *drawing, const struct Model *model) {
  const struct Spot corners[5] = {{-1.2, -1.2}, {1.2, -1.2}, {1.2, 1.2}, {-1.2, 1.2}, {-1.2, -1.2}};
  drawing->count = 0;
  append_shape(drawing, BOX, true, corners, 4);
  append_shape(drawing, BOX, false, corners, 5);
  append_signals(drawing, model->inputs.count, -1.9);
  append_signals(drawing, model->outputs.count + model->coordinates.count, 1.2);
  fit_drawing(drawing);
}

struct Drawing drawing_of(const struct Model *model, const struct Equations *equations) {
  struct Drawing drawing = {.count = 0};
  if (!draw_mechanism(&drawing, model, equations)) draw_block(&drawing, model);
  return drawing;
}
