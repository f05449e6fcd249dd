#include "mechanics/virtual_work.h"

#include "algebra/differentiate.h"
#include "algebra/simplify.h"
#include "base/memory.h"

void virtual_work_add(struct VirtualWork *work, Node moved, Node force) {
  if (moved == ZERO || force == ZERO) return;
  work->moved = make_room(work->moved, work->count, sizeof *work->moved);
  work->forces = make_room(work->forces, work->count, sizeof *work->forces);
  work->moved[work->count] = moved;
  work->forces[work->count++] = force;
}

Node *virtual_work_along(struct Graph *graph, const struct VirtualWork *work, enum SymbolKind kind, size_t count) {
  Node *along = allocate(count, sizeof *along);
  weighted_gradient_of(graph, work->moved, work->forces, work->count, kind, count, along);
  return along;
}

void virtual_work_add_along_rates(struct Graph *graph, const struct VirtualWork *work, enum SymbolKind kind,
                                  size_t count, Node *forces) {
  const Node *along = virtual_work_along(graph, work, kind, count);
  for (size_t i = 0; i + 1 < count; i++) forces[i] = add(graph, forces[i], along[i + 1]);
}
