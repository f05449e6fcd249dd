#include "mechanics/mass_matrix/inertia_derivation.h"

#include <string.h>

#include "algebra/simplify.h"
#include "base/memory.h"
#include "mechanics/mass_matrix/elimination.h"
#include "mechanics/mass_matrix/pivots.h"

/* The trees of a model that have factors. */
struct Trees {
  const size_t *tree_of; /* [rows]; NO_TREE for none */
  struct KnownTree {
    const struct ArticulatedTree *tree;
  } * items;
};

/* Returns the rows of a tree, ascending. */
static size_t *rows_of_tree(const struct KinematicTrees *kinematic_trees, size_t tree, size_t row_count,
                            size_t *count) {
  size_t *rows = allocate(row_count, sizeof *rows);
  *count = 0;
  for (size_t i = 0; i < row_count; i++)
    if (kinematic_trees->tree_of[i] == tree) rows[(*count)++] = i;
  return rows;
}

static struct Trees find_trees(const struct Model *model, struct KinematicTrees *kinematic_trees, size_t rows_in_all) {
  struct Graph *graph = model->graph;
  size_t count;
  struct Trees trees = {kinematic_trees->tree_of, allocate(rows_in_all, sizeof *trees.items)};
  for (size_t i = 0; i < rows_in_all && graph_limit(graph) == NULL; i++) {
    size_t tree = kinematic_trees->tree_of[i];
    if (tree == NO_TREE || trees.items[tree].tree != NULL) continue;
    size_t *rows = rows_of_tree(kinematic_trees, tree, rows_in_all, &count);
    trees.items[tree].tree = articulated_create(graph, kinematic_trees, tree, rows, count);
    if (trees.items[tree].tree != NULL && tree_has_factors(model, trees.items[tree].tree)) continue;
    trees.items[tree].tree = NULL;
    for (size_t k = 0; k < count; k++) kinematic_trees->tree_of[rows[k]] = NO_TREE;
  }
  return trees;
}

/* Couples the coordinates of each tree by elements of 0, so that they form one component. */
static void couple_trees(const struct Trees *trees, size_t coordinates, struct Elements *elements) {
  size_t *last = allocate(coordinates, sizeof *last); /* 1 + the last coordinate of each tree */
  for (size_t i = 0; i < coordinates; i++) {
    size_t tree = trees->tree_of[i];
    if (tree == NO_TREE) continue;
    if (last[tree] > 0) elements_append(elements, i, last[tree] - 1, ZERO);
    last[tree] = i + 1;
  }
}

/* Fills in the block of a tree; members are its rows. */
static void create_block_of_tree(struct Inertia *inertia, size_t number, size_t *members,
                                 const struct ArticulatedTree *tree) {
  struct InertiaBlock *block = &inertia->blocks[number];
  block->tree = tree;
  block->is_unrolled = true;
  block->coordinates = members;
  block->start = allocate(block->count + 1, sizeof *block->start);
}

/*
 * Returns the rank of each row for the elimination. The constraints that depend on others are those that are eliminated
 * last. Of constraints that contradict each other, a friction has to give way first, then a contact.
 */
static unsigned char *ranks_of(const struct Model *model, size_t count) {
  enum { OF_COORDINATE, OF_CONSTRAINT, OF_CONTACT, OF_FRICTION };
  const struct Switches *switches = &model->switches;
  size_t coordinates = model->coordinates.count;
  unsigned char *rank = allocate(count, sizeof *rank);
  memset(rank, OF_COORDINATE, count);
  if (count == coordinates) return rank;
  memset(rank + coordinates, OF_CONSTRAINT, count - coordinates);
  for (size_t i = 0; i < switches->contact_count; i++)
    rank[coordinates + switches->contacts[i].constraint] = OF_CONTACT;
  for (size_t i = 0; i < switches->friction_count; i++)
    rank[coordinates + switches->frictions[i].constraint] = OF_FRICTION;
  return rank;
}

/* Fills in a block with the elements from `from` to before `to`; members are its rows, ascending. */
static void create_block(const struct Graph *graph, struct Inertia *inertia, size_t number, size_t *members,
                         const struct Elements *elements, size_t from, size_t to) {
  struct InertiaBlock *block = &inertia->blocks[number];
  struct Position *local = allocate(to - from, sizeof *local);
  for (size_t k = from; k < to; k++)
    local[k - from] = (struct Position){inertia->index_in_block[elements->positions[k].row],
                                        inertia->index_in_block[elements->positions[k].column]};
  unsigned char *rank = allocate(block->count, sizeof *rank);
  for (size_t i = 0; i < block->count; i++) rank[i] = inertia->rank[members[i]];
  struct Elimination elimination = eliminate(graph, block->count, rank, local, to - from);
  block->start = elimination.start;
  block->column = elimination.column;
  block->coordinates = elimination.order;
  for (size_t index = 0; index < block->count; index++) {
    block->coordinates[index] = members[elimination.order[index]];
    inertia->index_in_block[block->coordinates[index]] = index;
  }
  block->mass = allocate(block->start[block->count], sizeof(Node));
  for (size_t k = from; k < to; k++)
    block->mass[inertia_find(inertia, elements->positions[k].row, elements->positions[k].column)] = elements->nodes[k];
}

/* Creates the blocks of a matrix of count rows, the last of which are those of constraints. */
static struct Inertia *create_blocks(const struct Model *model, size_t count, size_t constraint_count,
                                     struct Elements *elements, const struct Trees *trees) {
  struct ConnectedComponents components = find_components(count, elements);
  size_t *start = sort_by_components(elements, &components);
  struct Inertia *inertia = allocate(1, sizeof *inertia);
  *inertia = (struct Inertia){.count = count,
                              .coordinate_count = count - constraint_count,
                              .rank = ranks_of(model, count),
                              .block_of = components.of,
                              .index_in_block = allocate(count, sizeof(size_t))};
  inertia->block_count = components.count;
  inertia->blocks = allocate(components.count, sizeof *inertia->blocks);
  size_t **members = allocate(components.count, sizeof *members);
  for (size_t i = 0; i < count; i++) inertia->index_in_block[i] = inertia->blocks[components.of[i]].count++;
  for (size_t b = 0; b < components.count; b++) members[b] = allocate(inertia->blocks[b].count, sizeof **members);
  for (size_t i = 0; i < count; i++) members[components.of[i]][inertia->index_in_block[i]] = i;
  for (size_t i = count - constraint_count; i < count; i++) inertia->blocks[components.of[i]].constraint_count++;
  for (size_t b = 0; b < components.count; b++) {
    size_t first = members[b][0], tree = first < inertia->coordinate_count ? trees->tree_of[first] : NO_TREE;
    if (tree != NO_TREE) create_block_of_tree(inertia, b, members[b], trees->items[tree].tree);
    else create_block(model->graph, inertia, b, members[b], elements, start[b], start[b + 1]);
  }
  return inertia;
}

/* Returns the column of a force on which generalized forces depend; appends it if needed. */
static size_t nonsymmetric_column(struct InertiaBlock *block, size_t force) {
  for (size_t k = 0; k < block->force_count; k++)
    if (block->forces[k] == force) return k;
  size_t count = block->force_count++;
  block->forces = make_room(block->forces, count, sizeof *block->forces);
  for (size_t i = 0; i < block->count; i++) {
    block->nonsymmetric = make_room(block->nonsymmetric, count * block->count + i, sizeof *block->nonsymmetric);
    block->nonsymmetric[count * block->count + i] = ZERO;
  }
  block->forces[count] = force;
  return count;
}

static void add_nonsymmetric(struct Inertia *inertia, const struct Elements *nonsymmetric) {
  for (size_t k = 0; k < nonsymmetric->count; k++) {
    size_t row = inertia->coordinate_count + nonsymmetric->positions[k].row, column = nonsymmetric->positions[k].column;
    struct InertiaBlock *block = &inertia->blocks[inertia->block_of[row]];
    size_t index = nonsymmetric_column(block, inertia->index_in_block[row]);
    block->nonsymmetric[index * block->count + inertia->index_in_block[column]] = nonsymmetric->nodes[k];
  }
}

/* Gives zero rows, of open contacts and sliding frictions, a diagonal for the symbolic solution: their forces are 0. */
static void append_open_rows(const struct Model *model, struct Elements *elements) {
  struct Graph *graph = model->graph;
  const struct Switches *switches = &model->switches;
  for (size_t i = 0; i < switches->contact_count; i++) {
    size_t row = model->coordinates.count + switches->contacts[i].constraint;
    elements_append(elements, row, row, subtract(graph, switches->contacts[i].mode, ONE));
  }
  for (size_t i = 0; i < switches->friction_count; i++) {
    size_t row = model->coordinates.count + switches->frictions[i].constraint;
    elements_append(elements, row, row, negate(graph, power_number(graph, switches->frictions[i].mode, 2.0)));
  }
}

/* Creates the blocks of the matrix K with constraints (saddle.h). */
static struct Inertia *create_constrained(const struct Model *model, struct Elements *elements,
                                          const struct ConstraintBlock *constraint_block, const struct Trees *trees) {
  const struct Elements *jacobian = constraint_block->jacobian;
  size_t count = model->coordinates.count;
  if (model->unrolled) append_open_rows(model, elements);
  for (size_t k = 0; k < jacobian->count; k++)
    elements_append(elements, count + jacobian->positions[k].row, jacobian->positions[k].column, jacobian->nodes[k]);
  struct Inertia *inertia =
      create_blocks(model, count + constraint_block->count, constraint_block->count, elements, trees);
  add_nonsymmetric(inertia, constraint_block->nonsymmetric);
  return inertia;
}

struct Inertia *inertia_derive(const struct Model *model, const Node *momentum, Node regularization,
                               const struct ConstraintBlock *constraint_block, struct Diagnostics *diagnostics) {
  size_t count = model->coordinates.count;
  bool is_linear = model->linearized || (model->solver.method != NULL && model->solver.method->needs_linear);
  size_t rows = count + constraint_block->count;
  /* Formulas of linear systems need the elements of M. */
  struct KinematicTrees *kinematic_trees =
      is_linear ? no_kinematic_trees(rows) : kinematic_trees_create(model, constraint_block, regularization);
  struct Trees trees = find_trees(model, kinematic_trees, rows);
  struct Elements elements = elements_of(model, momentum, trees.tree_of);
  couple_trees(&trees, count, &elements);
  struct Inertia *inertia = create_blocks(model, count, 0, &elements, &trees);
  bool is_right = graph_limit(model->graph) != NULL || pivots_check(model, inertia, diagnostics);
  if (!is_right || constraint_block->count > 0)
    inertia = is_right ? create_constrained(model, &elements, constraint_block, &trees) : NULL;
  if (inertia == NULL || graph_limit(model->graph) != NULL) return inertia;
  /* The power of prescribed motions depends on accelerations, which are expressions unless there are constraints. */
  bool power_has_accelerations = constraint_block->count == 0 &&
                                 (model->prescribed.motion_count > 0 || model->prescribed.inputs_move) &&
                                 work_of(model) != NULL;
  bool unroll_all = power_has_accelerations || model->unrolled || is_linear;
  for (size_t b = 0; b < inertia->block_count; b++) {
    struct InertiaBlock *block = &inertia->blocks[b];
    if (block->tree == NULL)
      block->is_unrolled = unroll_all || (block->constraint_count == 0 && block->count <= UNROLL_LIMIT);
  }
  pivots_factor(model->graph, inertia);
  return inertia;
}
