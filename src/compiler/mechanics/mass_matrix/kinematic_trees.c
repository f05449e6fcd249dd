#include "mechanics/mass_matrix/kinematic_trees.h"

#include "algebra/cone.h"
#include "algebra/differentiate.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "model/time_derivative.h"

/*
 * Smallest mean number of coordinates on the path from the base to a coordinate of a tree. From here on, articulated
 * inertias take fewer operations than a factorization of M.
 */
static const double least_depth = 4.5;

/* Fewest links with coordinates in a tree; a single free body has two. */
enum { LEAST_LINKS = 6 };

/* State while the tree of links is built. */
struct TreeBuilder {
  const struct Model *model;
  struct KinematicTrees *trees;
  size_t row_count;     /* coordinates and constraints */
  size_t *last_link;    /* of each frame; NO_LINK if it is fixed to the base */
  size_t *link_of_body; /* of each body in a frame: the last link of its frame */
  size_t *link_of;      /* of each row; NO_LINK for none */
  bool *is_elsewhere;   /* of each row: inertia or constraints outside its link depend on it */
  Node *at_rest;        /* replacements of symbols: displacements are 0 */
};

static struct Vector without_displacements(const struct TreeBuilder *builder, struct Vector vector) {
  if (builder->model->displacements.count > 0)
    substitute(builder->model->graph, vector.along, 3, builder->at_rest, vector.along);
  return vector;
}

static bool is_symbol(const struct Graph *graph, Node node, enum SymbolKind kind) {
  return graph->vertices[node].operation == SYMBOL && graph->vertices[node].kinds == 1u << kind;
}

static size_t index_in_link(const struct TreeLink *link, size_t coordinate) {
  size_t index = 0;
  while (index < link->count && link->coordinates[index] != coordinate) index++;
  return index;
}

static void append_row(struct TreeLink *link, size_t row) {
  APPEND(link->coordinates, link->count, row);
}

/* Appends the coordinates on whose velocities a vector depends. */
static void find_coordinates(const struct TreeBuilder *builder, struct TreeLink *link, struct Vector velocity) {
  const struct Graph *graph = builder->model->graph;
  const struct Cone *cone = graph->cone;
  cone_collect(graph->cone, graph, velocity.along, 3);
  for (size_t i = 0; i < cone->count; i++) {
    if (!is_symbol(graph, cone->nodes[i], VELOCITY)) continue;
    size_t coordinate = (size_t)graph_symbol_of(graph, cone->nodes[i])->index;
    if (builder->model->prescribed.motions[coordinate].is_prescribed || index_in_link(link, coordinate) < link->count)
      continue;
    append_row(link, coordinate);
  }
}

/* Fills in the motion subspace: the derivatives of a velocity by those of the link's coordinates. */
static void set_motion_subspace(const struct TreeBuilder *builder, struct TreeLink *link, struct Vector velocity,
                                bool is_angular) {
  struct Graph *graph = builder->model->graph;
  for (int component = 0; component < 3; component++) {
    struct Gradient gradient = gradient_by_kinds(graph, velocity.along[component], 1u << VELOCITY);
    for (size_t i = 0; i < gradient.count; i++) {
      size_t index = index_in_link(link, (size_t)graph_symbol_of(graph, gradient.symbols[i])->index);
      if (index == link->count) continue; /* a prescribed coordinate */
      struct SpatialVector *axis = &link->motion_subspace[index];
      (is_angular ? &axis->angular : &axis->linear)->along[component] = gradient.values[i];
    }
  }
}

/* Fills in the pose of a link in its parent, and its motion subspace. */
static void set_motion(const struct TreeBuilder *builder, struct TreeLink *link) {
  for (int i = 0; i < 3; i++) link->pose.rotation.row[i] = without_displacements(builder, link->pose.rotation.row[i]);
  link->pose.origin = without_displacements(builder, link->pose.origin);
  link->motion_subspace = allocate(link->count, sizeof *link->motion_subspace);
  link->inertia = allocate(link->count * link->count, sizeof *link->inertia);
  set_motion_subspace(builder, link, without_displacements(builder, link->pose.velocity), false);
  set_motion_subspace(builder, link, without_displacements(builder, link->pose.angular_velocity), true);
}

/* Appends a link for a step from its parent. Returns its index. */
static size_t append_link(struct TreeBuilder *builder, size_t parent, const struct Pose *step) {
  struct KinematicTrees *trees = builder->trees;
  struct TreeLink link = {.parent = parent, .pose = *step};
  find_coordinates(builder, &link, step->velocity);
  find_coordinates(builder, &link, step->angular_velocity);
  for (size_t i = 0; i < link.count; i++) {
    size_t coordinate = link.coordinates[i];
    /* A coordinate that moves two links excludes a tree. */
    if (builder->link_of[coordinate] != NO_LINK) builder->is_elsewhere[coordinate] = true;
    builder->link_of[coordinate] = trees->count;
  }
  APPEND(trees->items, trees->count, link);
  return trees->count - 1;
}

static void create_links_of_frames(struct TreeBuilder *builder) {
  const struct Mechanism *mechanism = &builder->model->mechanism;
  builder->last_link = allocate(mechanism->frame_count, sizeof *builder->last_link);
  builder->last_link[0] = NO_LINK;
  for (size_t i = 1; i < mechanism->frame_count; i++) {
    const struct ReferenceFrame *frame = &mechanism->frames[i];
    size_t last = builder->last_link[frame->parent];
    for (size_t k = 0; k < frame->step_count; k++) last = append_link(builder, last, &frame->steps[k]);
    builder->last_link[i] = last;
  }
}

/* Appends a link for a body that moves in its frame. */
static void append_link_of_body(struct TreeBuilder *builder, size_t number) {
  struct Graph *graph = builder->model->graph;
  const struct Body *body = &builder->model->mechanism.bodies[number];
  bool moves = false;
  builder->link_of_body[number] = builder->last_link[body->frame];
  for (int i = 0; i < 3; i++) moves |= graph_depends_on(graph, body->offset.along[i], COORDINATE);
  if (!moves) return;
  struct Pose step = pose_of_base();
  step.origin = body->offset;
  derivative_along(graph, body->offset.along, 3, time_seeds(builder->model, false), step.velocity.along);
  builder->link_of_body[number] = append_link(builder, builder->last_link[body->frame], &step);
}

static void set_inertia_of_body(struct TreeBuilder *builder, size_t number) {
  struct Graph *graph = builder->model->graph;
  const struct Body *body = &builder->model->mechanism.bodies[number];
  size_t number_of_link = builder->link_of_body[number];
  if (number_of_link == NO_LINK) return;
  struct TreeLink *link = &builder->trees->items[number_of_link];
  struct Vector offset = body->offset;
  if (number_of_link != builder->last_link[body->frame]) offset = (struct Vector){{ZERO, ZERO, ZERO}};
  struct SpatialInertia inertia = spatial_inertia_of_body(graph, body->mass.node, offset, &body->tensor);
  link->bodies = spatial_inertia_add(graph, &link->bodies, &inertia);
}

static void mark_coordinates_of(struct TreeBuilder *builder, Node node) {
  const struct Graph *graph = builder->model->graph;
  const struct Cone *cone = graph->cone;
  cone_collect(graph->cone, graph, &node, 1);
  for (size_t i = 0; i < cone->count; i++)
    if (is_symbol(graph, cone->nodes[i], COORDINATE))
      builder->is_elsewhere[graph_symbol_of(graph, cone->nodes[i])->index] = true;
}

static void append_links_of_bodies(struct TreeBuilder *builder) {
  const struct Mechanism *mechanism = &builder->model->mechanism;
  builder->link_of_body = allocate(mechanism->body_count, sizeof *builder->link_of_body);
  for (size_t i = 0; i < mechanism->body_count; i++) {
    const struct Body *body = &mechanism->bodies[i];
    if (body->is_in_frame) append_link_of_body(builder, i);
    for (int k = 0; k < 3 && !body->is_in_frame && body->mass.node != ZERO; k++)
      mark_coordinates_of(builder, body->position[k].node);
    if (!body->is_in_frame && body->inertia.node != ZERO) mark_coordinates_of(builder, body->angle.node);
  }
}

static void add_inertia(struct TreeLink *link, size_t i, size_t j, Node value) {
  link->inertia[index_in_link(link, i) * link->count + index_in_link(link, j)] = value;
  link->has_inertia = true;
}

/*
 * Adds the inertia of <kinetic> terms, potentials and regularization. It must couple coordinates of the same link only.
 */
static void add_further_inertia(struct TreeBuilder *builder, Node regularization) {
  const struct Model *model = builder->model;
  struct Graph *graph = model->graph;
  size_t n = model->coordinates.count;
  Node *momentum = allocate(n, sizeof *momentum);
  Node kinetic = add(graph, model->energies.explicit_kinetic.node, regularization);
  gradient_of(graph, subtract(graph, kinetic, model->energies.potential.node), VELOCITY, n, momentum);
  for (size_t i = 0; i < n && graph_limit(graph) == NULL; i++) {
    struct Gradient row = gradient_by_kinds(graph, momentum[i], 1u << VELOCITY);
    for (size_t k = 0; k < row.count; k++) {
      size_t j = (size_t)graph_symbol_of(graph, row.symbols[k])->index;
      if (model->prescribed.motions[i].is_prescribed || model->prescribed.motions[j].is_prescribed) continue;
      if (builder->link_of[i] == builder->link_of[j] && builder->link_of[i] != NO_LINK)
        add_inertia(&builder->trees->items[builder->link_of[i]], i, j, row.values[k]);
      else builder->is_elsewhere[i] = builder->is_elsewhere[j] = true;
    }
  }
}

/* Returns the nearest link with coordinates, from this one towards the base. */
static size_t moved_link(const struct KinematicTrees *trees, size_t link) {
  while (link != NO_LINK && trees->items[link].count == 0) link = trees->items[link].parent;
  return link;
}

/* Finds the components of rows: coordinates on one path to the base move the same bodies. */
static struct ConnectedComponents couple(const struct TreeBuilder *builder) {
  const struct KinematicTrees *trees = builder->trees;
  struct Elements couplings = {0};
  for (size_t i = 0; i < trees->count; i++) {
    const struct TreeLink *link = &trees->items[i];
    size_t before = link->count > 0 ? moved_link(trees, link->parent) : NO_LINK;
    for (size_t k = 1; k < link->count; k++)
      elements_append(&couplings, link->coordinates[k], link->coordinates[0], ZERO);
    if (before != NO_LINK) elements_append(&couplings, link->coordinates[0], trees->items[before].coordinates[0], ZERO);
  }
  return find_components(builder->row_count, &couplings);
}

static void mark_columns(struct TreeBuilder *builder, const struct Elements *elements, const bool *is_local) {
  for (size_t k = 0; k < elements->count; k++)
    if (is_local == NULL || !is_local[elements->positions[k].row])
      builder->is_elsewhere[elements->positions[k].column] = true;
}

/* Excludes constraints that share a link: they may depend on each other, which only saddle.h detects. */
static void leave_shared_links(const struct TreeBuilder *builder, const size_t *link, size_t count, bool *is_local) {
  size_t *counts = allocate(builder->trees->count, sizeof *counts);
  for (size_t j = 0; j < count; j++)
    if (is_local[j]) counts[link[j]]++;
  for (size_t j = 0; j < count; j++) is_local[j] = is_local[j] && counts[link[j]] == 1;
}

/*
 * Returns, for each constraint, whether it is local. A local constraint is permanent, and the only one on the
 * coordinates of a single link, as the norm of a quaternion is. If coordinates are fixed at the start, none is.
 */
static bool *find_local_constraints(const struct TreeBuilder *builder, const struct ConstraintBlock *constraint_block) {
  const struct Model *model = builder->model;
  const struct Elements *jacobian = constraint_block->jacobian;
  bool *is_local = allocate(constraint_block->count, sizeof *is_local);
  size_t *link = allocate(constraint_block->count, sizeof *link);
  bool *is_met = allocate(constraint_block->count, sizeof *is_met);
  for (size_t j = 0; j < constraint_block->count; j++)
    is_local[j] =
        !graph_depends_on(model->graph, model->constraints.items[j].node, MODE) && !has_fixed_coordinates(model);
  for (size_t k = 0; k < jacobian->count; k++) {
    size_t row = jacobian->positions[k].row, of = builder->link_of[jacobian->positions[k].column];
    if (of == NO_LINK || (is_met[row] && link[row] != of)) is_local[row] = false;
    link[row] = of;
    is_met[row] = true;
  }
  for (size_t j = 0; j < constraint_block->count; j++) is_local[j] &= is_met[j];
  leave_shared_links(builder, link, constraint_block->count, is_local);
  return is_local;
}

/* Adds a constraint within one link to its rows, without motion. Others exclude a tree; saddle.h solves them. */
static void add_constraints(struct TreeBuilder *builder, const struct ConstraintBlock *constraint_block) {
  const struct Elements *jacobian = constraint_block->jacobian;
  size_t n = builder->model->coordinates.count;
  const bool *is_local = find_local_constraints(builder, constraint_block);
  mark_columns(builder, jacobian, is_local);
  mark_columns(builder, constraint_block->nonsymmetric, NULL);
  for (size_t k = 0; k < jacobian->count; k++) {
    size_t row = n + jacobian->positions[k].row;
    if (!is_local[row - n] || builder->link_of[row] != NO_LINK) continue;
    builder->link_of[row] = builder->link_of[jacobian->positions[k].column];
    append_row(&builder->trees->items[builder->link_of[row]], row);
  }
}

/* Fills in the elements of J in these rows. */
static void set_constraints(struct TreeBuilder *builder, const struct ConstraintBlock *constraint_block) {
  const struct Elements *jacobian = constraint_block->jacobian;
  size_t n = builder->model->coordinates.count;
  for (size_t k = 0; k < jacobian->count; k++) {
    size_t row = n + jacobian->positions[k].row, column = jacobian->positions[k].column;
    if (builder->link_of[row] == NO_LINK) continue;
    struct TreeLink *link = &builder->trees->items[builder->link_of[row]];
    add_inertia(link, row, column, jacobian->nodes[k]);
    add_inertia(link, column, row, jacobian->nodes[k]);
  }
}

/* Returns, for each component, whether it has enough links and is deep enough on average. */
static bool *are_deep_trees(const struct KinematicTrees *trees, const struct ConnectedComponents *components) {
  double *depth = allocate(trees->count, sizeof *depth), *sum = allocate(components->count, sizeof *sum),
         *count = allocate(components->count, sizeof *count);
  size_t *moving = allocate(components->count, sizeof *moving);
  bool *is_deep = allocate(components->count, sizeof *is_deep);
  for (size_t i = 0; i < trees->count; i++) {
    const struct TreeLink *link = &trees->items[i];
    depth[i] = (double)link->count + (link->parent != NO_LINK ? depth[link->parent] : 0.0);
    if (link->count == 0) continue;
    size_t component = components->of[link->coordinates[0]];
    sum[component] += (double)link->count * depth[i];
    count[component] += (double)link->count;
    moving[component]++;
  }
  for (size_t c = 0; c < components->count; c++)
    is_deep[c] = moving[c] >= LEAST_LINKS && sum[c] >= least_depth * count[c];
  return is_deep;
}

/* Chooses the components that are trees as a whole, and deep. True if there are any. */
static bool choose_trees(struct TreeBuilder *builder, const struct ConnectedComponents *components) {
  struct KinematicTrees *trees = builder->trees;
  size_t n = builder->row_count;
  bool *is_tree = are_deep_trees(trees, components), any = false;
  for (size_t i = 0; i < n; i++)
    if (builder->is_elsewhere[i] || builder->link_of[i] == NO_LINK) is_tree[components->of[i]] = false;
  for (size_t i = 0; i < n; i++) {
    trees->tree_of[i] = is_tree[components->of[i]] ? components->of[i] : NO_TREE;
    any |= is_tree[components->of[i]];
  }
  for (size_t i = 0; i < trees->count; i++) {
    size_t moved = moved_link(trees, i);
    trees->items[i].tree = moved != NO_LINK ? trees->tree_of[trees->items[moved].coordinates[0]] : NO_TREE;
  }
  return any;
}

/*
 * Fills in motion subspaces and inertias. No node is made before, so that systems without trees have the same nodes as
 * without this search.
 */
static void set_links(struct TreeBuilder *builder, const struct ConstraintBlock *constraint_block,
                      Node regularization) {
  for (size_t i = 0; i < builder->trees->count; i++) set_motion(builder, &builder->trees->items[i]);
  for (size_t i = 0; i < builder->model->mechanism.body_count; i++)
    if (builder->model->mechanism.bodies[i].is_in_frame) set_inertia_of_body(builder, i);
  add_further_inertia(builder, regularization);
  set_constraints(builder, constraint_block);
}

struct KinematicTrees *no_kinematic_trees(size_t row_count) {
  struct KinematicTrees *trees = allocate(1, sizeof *trees);
  trees->tree_of = allocate(row_count, sizeof *trees->tree_of);
  for (size_t i = 0; i < row_count; i++) trees->tree_of[i] = NO_TREE;
  return trees;
}

struct KinematicTrees *kinematic_trees_create(const struct Model *model, const struct ConstraintBlock *constraint_block,
                                              Node regularization) {
  size_t rows = model->coordinates.count + constraint_block->count;
  struct TreeBuilder builder = {.model = model,
                                .trees = no_kinematic_trees(rows),
                                .row_count = rows,
                                .link_of = allocate(rows, sizeof *builder.link_of),
                                .is_elsewhere = allocate(rows, sizeof *builder.is_elsewhere),
                                .at_rest = own_symbols(model->graph)};
  for (size_t i = 0; i < model->graph->symbol_count; i++)
    if (model->graph->symbols[i].kind == DISPLACEMENT) builder.at_rest[i] = ZERO;
  for (size_t i = 0; i < rows; i++) builder.link_of[i] = NO_LINK;
  create_links_of_frames(&builder);
  append_links_of_bodies(&builder);
  add_constraints(&builder, constraint_block);
  struct ConnectedComponents components = couple(&builder);
  if (!choose_trees(&builder, &components)) return builder.trees;
  set_links(&builder, constraint_block, regularization);
  choose_trees(&builder, &components);
  return builder.trees;
}
