#include "mechanics/mass_matrix/articulated.h"

#include "algebra/simplify.h"
#include "base/memory.h"

static struct FactorPattern full_pattern(size_t count) {
  size_t *start = allocate(count + 1, sizeof *start), *column = allocate(count * (count + 1) / 2, sizeof *column);
  for (size_t i = 0; i < count; i++) {
    start[i + 1] = start[i] + i + 1;
    for (size_t j = 0; j <= i; j++) column[start[i] + j] = j;
  }
  return (struct FactorPattern){count, start, column};
}

/* Returns the index, 0 to 5, of the only component that is not ZERO; -1 if there are several. */
static int only_component(struct SpatialVector axis) {
  int only = -1;
  for (int i = 0; i < 6; i++) {
    if ((i < 3 ? axis.linear.along[i] : axis.angular.along[i - 3]) == ZERO) continue;
    if (only >= 0) return -1;
    only = i;
  }
  return only;
}

/* Clears the component of a free motion, along which the articulated inertia is 0. */
static void clear_component(struct SpatialInertia *inertia, int component) {
  int i = component % 3;
  for (int j = 0; j < 3; j++) {
    if (component < 3) {
      inertia->mass.row[i].along[j] = inertia->mass.row[j].along[i] = ZERO;
      inertia->coupling.row[i].along[j] = ZERO;
    } else {
      inertia->moment.row[i].along[j] = inertia->moment.row[j].along[i] = ZERO;
      inertia->coupling.row[j].along[i] = ZERO;
    }
  }
}

/* Computes U = inertia S and the masses D = S^T U + inertia of the coordinates. Returns U. */
static struct SpatialVector *set_masses(struct Graph *graph, struct ArticulatedLink *item,
                                        const struct SpatialInertia *inertia) {
  const struct TreeLink *link = item->link;
  struct SpatialVector *force = allocate(link->count, sizeof *force);
  item->pattern = full_pattern(link->count);
  item->mass = allocate(item->pattern.start[link->count], sizeof *item->mass);
  for (size_t i = 0; i < link->count; i++) {
    force[i] = spatial_inertia_apply(graph, inertia, link->motion_subspace[i]);
    for (size_t j = 0; j <= i; j++) {
      Node mass = spatial_dot(graph, force[i], link->motion_subspace[j]);
      item->mass[item->pattern.start[i] + j] = add(graph, mass, link->inertia[i * link->count + j]);
    }
  }
  return force;
}

/* Computes the gains U D^-1. */
static void set_gains(struct Graph *graph, struct ArticulatedLink *item, const struct SpatialVector *force) {
  size_t count = item->link->count;
  Node *x = allocate(count, sizeof *x);
  item->gain = allocate(count, sizeof *item->gain);
  for (int component = 0; component < 6; component++) {
    int k = component % 3;
    for (size_t i = 0; i < count; i++) x[i] = component < 3 ? force[i].linear.along[k] : force[i].angular.along[k];
    factors_solve(graph, &item->pattern, item->factor, x);
    for (size_t i = 0; i < count; i++)
      (component < 3 ? &item->gain[i].linear : &item->gain[i].angular)->along[k] = x[i];
  }
}

/* Returns the articulated inertia without the free motions of the link: inertia - U D^-1 U^T. */
static struct SpatialInertia eliminate_link(struct Graph *graph, struct ArticulatedLink *item,
                                            struct SpatialInertia inertia) {
  const struct TreeLink *link = item->link;
  if (link->count == 0) return inertia;
  const struct SpatialVector *force = set_masses(graph, item, &inertia);
  item->factor = factors_create(graph, &item->pattern, item->mass);
  set_gains(graph, item, force);
  for (size_t i = 0; i < link->count; i++) inertia = spatial_inertia_subtract(graph, &inertia, item->gain[i], force[i]);
  for (size_t i = 0; i < link->count && !link->has_inertia; i++) {
    int component = only_component(link->motion_subspace[i]);
    if (component >= 0) clear_component(&inertia, component);
  }
  return inertia;
}

/*
 * Upper bounds of the inertia outward of a link, with all distances stretched. Rotations leave them unchanged, so that
 * outward of revolute joints they depend only on parameters.
 */
struct Load {
  Node mass;
  Node first_moment; /* at most the mass times the distance of the centre of mass from the link's origin */
  Node trace;        /* at most the trace of the moments about the origin */
};

static Node length_of(struct Graph *graph, struct Vector vector) {
  return power_number(graph, vector_dot(graph, vector, vector), 0.5);
}

/* Returns the load of a link, with that of the outward links. */
static struct Load load_of(struct Graph *graph, const struct SpatialInertia *bodies, const struct Load *behind) {
  const struct Vector *moment = bodies->moment.row, *coupling = bodies->coupling.row;
  struct Vector first_moment = {{coupling[1].along[2], coupling[2].along[0], coupling[0].along[1]}}; /* from -[lever] */
  struct Load load = {.mass = add(graph, bodies->mass.row[0].along[0], behind->mass),
                      .first_moment = add(graph, length_of(graph, first_moment), behind->first_moment),
                      .trace = behind->trace};
  for (int i = 0; i < 3; i++) load.trace = add(graph, load.trace, moment[i].along[i]);
  return load;
}

static void add_load_to_parent(struct Graph *graph, struct Load *parent, const struct Pose *pose, struct Load load) {
  Node distance = length_of(graph, pose->origin), shift = multiply(graph, load.mass, distance);
  Node steiner = multiply(graph, distance, add(graph, scale(graph, 2.0, load.first_moment), shift));
  parent->mass = add(graph, parent->mass, load.mass);
  parent->first_moment = add(graph, parent->first_moment, add(graph, load.first_moment, shift));
  parent->trace = add(graph, parent->trace, add(graph, load.trace, scale(graph, 2.0, steiner)));
}

/* Computes bounds of the diagonal elements of M. A pivot far below one is rounding error. */
static void set_scales(struct Graph *graph, struct ArticulatedLink *item, const struct Load *load) {
  const struct TreeLink *link = item->link;
  item->scale = allocate(link->count, sizeof *item->scale);
  for (size_t i = 0; i < link->count; i++) {
    struct SpatialVector axis = link->motion_subspace[i];
    Node moved = multiply(graph, load->mass, vector_dot(graph, axis.linear, axis.linear));
    Node rotating = multiply(graph, load->trace, vector_dot(graph, axis.angular, axis.angular));
    item->scale[i] = add(graph, add(graph, moved, rotating), link->inertia[i * link->count + i]);
  }
}

static void eliminate_all(struct Graph *graph, struct ArticulatedTree *tree) {
  struct SpatialInertia *behind = allocate(tree->count, sizeof *behind);
  struct Load *loads = allocate(tree->count, sizeof *loads);
  for (size_t i = tree->count; i-- > 0;) {
    struct ArticulatedLink *item = &tree->items[i];
    struct SpatialInertia whole = spatial_inertia_add(graph, &item->link->bodies, &behind[i]);
    struct SpatialInertia left = eliminate_link(graph, item, whole);
    struct Load load = load_of(graph, &item->link->bodies, &loads[i]);
    set_scales(graph, item, &load);
    if (item->parent == NO_LINK) continue;
    add_load_to_parent(graph, &loads[item->parent], &item->link->pose, load);
    left = spatial_inertia_to_parent(graph, &item->link->pose, &left);
    behind[item->parent] = spatial_inertia_add(graph, &behind[item->parent], &left);
  }
}

static struct ArticulatedTree *collect_links(const struct KinematicTrees *trees, size_t tree, const size_t *coordinates,
                                             size_t row_count) {
  struct ArticulatedTree *result = allocate(1, sizeof *result);
  size_t *index = allocate(trees->count, sizeof *index);
  *result = (struct ArticulatedTree){.items = allocate(trees->count, sizeof *result->items), .row_count = row_count};
  for (size_t i = 0; i < trees->count; i++) {
    const struct TreeLink *link = &trees->items[i];
    if (link->tree != tree) continue;
    bool is_inside = link->parent != NO_LINK && trees->items[link->parent].tree == tree;
    index[i] = result->count;
    struct ArticulatedLink *item = &result->items[result->count++];
    *item = (struct ArticulatedLink){.link = link, .parent = is_inside ? index[link->parent] : NO_LINK};
    item->rows = allocate(link->count, sizeof *item->rows);
    for (size_t k = 0; k < link->count; k++)
      while (coordinates[item->rows[k]] != link->coordinates[k]) item->rows[k]++;
  }
  return result;
}

struct ArticulatedTree *articulated_create(struct Graph *graph, const struct KinematicTrees *trees, size_t tree,
                                           const size_t *coordinates, size_t row_count) {
  struct ArticulatedTree *result = collect_links(trees, tree, coordinates, row_count);
  bool was_not_finite = graph->not_finite;
  graph->not_finite = false;
  eliminate_all(graph, result);
  if (graph->not_finite) result = NULL;
  graph->not_finite = was_not_finite;
  return result;
}

Node articulated_pivot(const struct ArticulatedTree *tree, size_t row) {
  for (size_t i = 0; i < tree->count; i++)
    for (size_t k = 0; k < tree->items[i].link->count; k++)
      if (tree->items[i].rows[k] == row) return tree->items[i].factor[tree->items[i].pattern.start[k + 1] - 1];
  return ZERO;
}

void articulated_solve(struct Graph *graph, const struct ArticulatedTree *tree, Node *x) {
  struct SpatialVector *force = allocate(tree->count, sizeof *force), *motion = allocate(tree->count, sizeof *motion);
  Node *pushed = allocate(tree->row_count, sizeof *pushed);
  for (size_t i = tree->count; i-- > 0;) {
    const struct ArticulatedLink *item = &tree->items[i];
    const struct TreeLink *link = item->link;
    for (size_t k = 0; k < link->count; k++)
      pushed[k] = subtract(graph, x[item->rows[k]], spatial_dot(graph, force[i], link->motion_subspace[k]));
    for (size_t k = 0; k < link->count; k++)
      force[i] = spatial_add(graph, force[i], spatial_scale(graph, pushed[k], item->gain[k]));
    if (link->count > 0) factors_solve(graph, &item->pattern, item->factor, pushed);
    for (size_t k = 0; k < link->count; k++) x[item->rows[k]] = pushed[k];
    if (item->parent == NO_LINK) continue;
    struct SpatialVector handed_on = spatial_force_to_parent(graph, &link->pose, force[i]);
    force[item->parent] = spatial_add(graph, force[item->parent], handed_on);
  }
  for (size_t i = 0; i < tree->count; i++) {
    const struct ArticulatedLink *item = &tree->items[i];
    const struct TreeLink *link = item->link;
    if (item->parent != NO_LINK) motion[i] = spatial_motion_from_parent(graph, &link->pose, motion[item->parent]);
    const struct SpatialVector carried = motion[i];
    for (size_t k = 0; k < link->count; k++) {
      Node *acceleration = &x[item->rows[k]];
      *acceleration = subtract(graph, *acceleration, spatial_dot(graph, item->gain[k], carried));
      motion[i] = spatial_add(graph, motion[i], spatial_scale(graph, *acceleration, link->motion_subspace[k]));
    }
  }
}

void articulated_add_product(struct Graph *graph, const struct ArticulatedTree *tree, const Node *x, Node *sum) {
  struct SpatialVector *force = allocate(tree->count, sizeof *force), *motion = allocate(tree->count, sizeof *motion);
  for (size_t i = 0; i < tree->count; i++) {
    const struct ArticulatedLink *item = &tree->items[i];
    if (item->parent != NO_LINK) motion[i] = spatial_motion_from_parent(graph, &item->link->pose, motion[item->parent]);
    for (size_t k = 0; k < item->link->count; k++)
      motion[i] = spatial_add(graph, motion[i], spatial_scale(graph, x[item->rows[k]], item->link->motion_subspace[k]));
  }
  for (size_t i = tree->count; i-- > 0;) {
    const struct ArticulatedLink *item = &tree->items[i];
    const struct TreeLink *link = item->link;
    force[i] = spatial_add(graph, force[i], spatial_inertia_apply(graph, &link->bodies, motion[i]));
    for (size_t k = 0; k < link->count; k++) {
      Node *along = &sum[item->rows[k]];
      *along = add(graph, *along, spatial_dot(graph, force[i], link->motion_subspace[k]));
      for (size_t l = 0; l < link->count; l++)
        *along = add(graph, *along, multiply(graph, link->inertia[k * link->count + l], x[item->rows[l]]));
    }
    if (item->parent == NO_LINK) continue;
    struct SpatialVector handed_on = spatial_force_to_parent(graph, &link->pose, force[i]);
    force[item->parent] = spatial_add(graph, force[item->parent], handed_on);
  }
}
