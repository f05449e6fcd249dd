#include "program/result_groups.h"

#include <stdint.h>

#include "base/memory.h"
#include "base/sorting.h"
#include "program/codegen/fused_operations.h"

/*
 * LONG_ENOUGH: objects that need fewer nodes stay by themselves. SIZE_LIMIT: results in a group, whose values stand in
 * a local array. OPEN_GROUPS: groups that objects can join at a time, since frames and bodies alternate.
 */
enum { LONG_ENOUGH = 1000, SIZE_LIMIT = 1024, OPEN_GROUPS = 4 };

/* A group that objects can still join, and the nodes that it needs. */
struct ResultGroup {
  size_t leader, size;
  bool *needs; /* indexed by node */
  struct NodeList needed;
  size_t shortest; /* the node count of the object that needs the fewest */
};

/* The groups that can still grow, replaced in turn. */
struct OpenGroups {
  struct ResultGroup groups[OPEN_GROUPS];
  size_t next; /* index of the group that the next new one replaces */
};

/* True if the object in the cone may join: the group then needs at most 1.5 times the nodes of each object. */
static bool may_join(const struct Cone *cone, const struct ResultGroup *group, size_t size_of_object) {
  size_t shortest = smaller(cone->count, group->shortest), count = group->needed.count;
  if (group->size == 0 || group->size + size_of_object > SIZE_LIMIT) return false;
  for (size_t i = 0; i < cone->count; i++) count += !group->needs[cone->nodes[i]];
  return 2 * count <= 3 * shortest;
}

static void begin(const struct Graph *graph, struct ResultGroup *group, size_t leader) {
  if (group->needs == NULL) group->needs = allocate(graph->count, sizeof *group->needs);
  for (size_t i = 0; i < group->needed.count; i++) group->needs[group->needed.nodes[i]] = false;
  group->needed.count = 0;
  group->leader = leader;
  group->size = 0;
  group->shortest = SIZE_MAX;
}

static void add_needs(const struct Cone *cone, struct ResultGroup *group) {
  group->shortest = smaller(cone->count, group->shortest);
  for (size_t i = 0; i < cone->count; i++) {
    if (group->needs[cone->nodes[i]]) continue;
    group->needs[cone->nodes[i]] = true;
    append_node(&group->needed, cone->nodes[i]);
  }
}

/* Returns the group that the object joins, or a new one in place of the oldest. */
static struct ResultGroup *find_group(const struct NeededNodes *needs, struct OpenGroups *open, size_t leader,
                                      size_t size_of_object) {
  for (size_t i = 0; i < OPEN_GROUPS; i++)
    if (may_join(needs->cone, &open->groups[i], size_of_object)) return &open->groups[i];
  struct ResultGroup *group = &open->groups[open->next];
  open->next = (open->next + 1) % OPEN_GROUPS;
  begin(needs->graph, group, leader);
  return group;
}

/* Assigns the object with the results first .. first + size - 1 to a group. */
static void assign_object(struct ResultGroups *groups, struct NeededNodes *needs, const Node *result, size_t first,
                          size_t size, struct OpenGroups *open) {
  const struct Cone *cone = needs->cone;
  for (size_t i = 0; i < size; i++) {
    groups->leader[first + i] = first;
    groups->slot[first + i] = i;
  }
  needs_collect(needs, result + first, size, false);
  if (cone->count < LONG_ENOUGH) return;
  struct ResultGroup *group = find_group(needs, open, first, size);
  add_needs(cone, group);
  for (size_t i = 0; i < size; i++) {
    groups->leader[first + i] = group->leader;
    groups->slot[first + i] = group->size++;
  }
}

struct ResultGroups result_groups_of(const struct Expressions *expressions) {
  const struct Interface *interface = expressions->interface;
  const struct Graph *graph = expressions->model->graph;
  struct ResultGroups groups = groups_of_one(interface->result_count);
  struct NeededNodes *needs = needs_create(graph);
  struct OpenGroups open[2] = {0}; /* without and with accelerations, which may be undetermined */
  for (size_t i = 0; i < interface->count && graph_limit(graph) == NULL; i++) {
    const struct InterfaceVariable *variable = &interface->variables[i];
    size_t first = variable->entry.index, size = 1;
    if (variable->entry.kind != VARIABLE_RESULT || variable->is_continued) continue;
    while (i + size < interface->count && variable[size].is_continued) size++;
    bool has_accelerations = graph_depends_on(graph, expressions->result[first], ACCELERATION);
    assign_object(&groups, needs, expressions->result, first, size, &open[has_accelerations]);
  }
  return groups;
}

struct ResultGroups groups_of_one(size_t count) {
  struct ResultGroups groups = {
      .count = count, .leader = allocate(count, sizeof *groups.leader), .slot = allocate(count, sizeof *groups.slot)};
  for (size_t i = 0; i < count; i++) groups.leader[i] = i;
  return groups;
}

struct NodeList group_members(const struct ResultGroups *groups, const Node *result, size_t leader) {
  struct NodeList members = {0};
  for (size_t i = leader; i < groups->count; i++)
    if (groups->leader[i] == leader) append_node(&members, result[i]);
  return members;
}
