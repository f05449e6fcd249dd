#include "mechanics/mass_matrix/elimination.h"

#include <stdbool.h>

#include "base/memory.h"
#include "base/sorting.h"

int compare_positions(const void *first, const void *second) {
  const struct Position *a = first, *b = second;
  int order = compare_sizes(&a->column, &b->column);
  return order != 0 ? order : compare_sizes(&a->row, &b->row);
}

/* The neighbours of a row in the elimination graph, ascending. */
struct NeighbourSet {
  size_t *items;
  size_t count;
};

/* A priority queue of rows, as a binary heap: the lowest degree first. Entries with an outdated degree are skipped. */
struct QueueEntry {
  size_t degree, row;
};

/* The heap: no item precedes its parent, item (i - 1) / 2. */
struct Queue {
  struct QueueEntry *items;
  size_t count;
};

static bool precedes(struct QueueEntry a, struct QueueEntry b) {
  return a.degree < b.degree || (a.degree == b.degree && a.row < b.row);
}

static void push(struct Queue *queue, struct QueueEntry entry) {
  queue->items = make_room(queue->items, queue->count, sizeof *queue->items);
  size_t index = queue->count++;
  for (; index > 0 && precedes(entry, queue->items[(index - 1) / 2]); index = (index - 1) / 2)
    queue->items[index] = queue->items[(index - 1) / 2];
  queue->items[index] = entry;
}

static struct QueueEntry pop(struct Queue *queue) {
  struct QueueEntry top = queue->items[0], last = queue->items[--queue->count];
  size_t index = 0;
  for (size_t child = 1; child < queue->count; child = 2 * index + 1) {
    if (child + 1 < queue->count && precedes(queue->items[child + 1], queue->items[child])) child++;
    if (!precedes(queue->items[child], last)) break;
    queue->items[index] = queue->items[child];
    index = child;
  }
  queue->items[index] = last;
  return top;
}

static struct NeighbourSet *neighbours_of(size_t count, const struct Position *positions, size_t position_count) {
  struct NeighbourSet *sets = allocate(count, sizeof *sets);
  size_t *degree = allocate(count, sizeof *degree);
  for (size_t i = 0; i < position_count; i++) {
    if (positions[i].row == positions[i].column) continue;
    degree[positions[i].row]++;
    degree[positions[i].column]++;
  }
  for (size_t i = 0; i < count; i++) sets[i].items = allocate(degree[i], sizeof(size_t));
  for (size_t i = 0; i < position_count; i++) {
    size_t row = positions[i].row, column = positions[i].column;
    if (row == column) continue;
    sets[row].items[sets[row].count++] = column;
    sets[column].items[sets[column].count++] = row;
  }
  for (size_t i = 0; i < count; i++) sort_sizes(sets[i].items, sets[i].count);
  release(degree);
  return sets;
}

/* Adds the neighbours of the eliminated row; removes that row, and the row itself. */
static void join(struct NeighbourSet *set, size_t row, const struct NeighbourSet *others, size_t eliminated) {
  struct NeighbourSet joined = {.items = allocate(set->count + others->count, sizeof(size_t))};
  for (size_t i = 0, j = 0; i < set->count || j < others->count;) {
    size_t next =
        j == others->count || (i < set->count && set->items[i] < others->items[j]) ? set->items[i] : others->items[j];
    if (next != row && next != eliminated) joined.items[joined.count++] = next;
    while (i < set->count && set->items[i] == next) i++;
    while (j < others->count && others->items[j] == next) j++;
  }
  release(set->items);
  *set = joined;
}

/* True if a row has to wait for a neighbour of a lower rank. It is pushed again when that is gone. */
static bool has_to_wait(const unsigned char *rank, size_t row, const struct NeighbourSet *set) {
  for (size_t i = 0; i < set->count && rank != NULL; i++)
    if (rank[set->items[i]] < rank[row]) return true;
  return false;
}

/* Eliminates all rows. Afterwards the sets are the columns of L below the diagonal. */
static void eliminate_rows(const struct Graph *graph, size_t count, const unsigned char *rank,
                           struct NeighbourSet *sets, size_t *order, size_t *index) {
  struct Queue queue = {0};
  bool *is_eliminated = allocate(count, sizeof *is_eliminated);
  for (size_t row = 0; row < count; row++) push(&queue, (struct QueueEntry){sets[row].count, row});
  size_t next = 0;
  while (next < count && graph_limit(graph) == NULL) {
    struct QueueEntry waiting = pop(&queue);
    const struct NeighbourSet *set = &sets[waiting.row];
    if (is_eliminated[waiting.row] || waiting.degree != set->count) continue;
    if (has_to_wait(rank, waiting.row, set)) continue;
    is_eliminated[waiting.row] = true;
    index[waiting.row] = next;
    order[next++] = waiting.row;
    for (size_t i = 0; i < set->count; i++) {
      size_t row = set->items[i];
      graph_work(graph, sets[row].count + set->count);
      join(&sets[row], row, set, waiting.row);
      push(&queue, (struct QueueEntry){sets[row].count, row});
    }
  }
  for (size_t row = 0; row < count; row++) {
    if (is_eliminated[row]) continue;
    index[row] = next;
    order[next++] = row;
  }
}

static struct Elimination full_elimination(size_t count) {
  struct Elimination result = {.order = allocate(count, sizeof(size_t)), .start = allocate(count + 1, sizeof(size_t))};
  result.column = allocate(count * (count + 1) / 2, sizeof(size_t));
  for (size_t i = 0; i < count; i++) {
    result.order[i] = i;
    result.start[i + 1] = result.start[i] + i + 1;
    for (size_t j = 0; j <= i; j++) result.column[result.start[i] + j] = j;
  }
  return result;
}

/* True if no row has a lower rank than the one before it. */
static bool is_ascending(const unsigned char *rank, size_t count) {
  bool ascends = true;
  for (size_t i = 1; i < count && rank != NULL; i++) ascends &= rank[i] >= rank[i - 1];
  return ascends;
}

struct Elimination eliminate(const struct Graph *graph, size_t count, const unsigned char *rank,
                             const struct Position *positions, size_t position_count) {
  if (position_count == count * (count + 1) / 2 && is_ascending(rank, count)) return full_elimination(count);
  struct Elimination result = {.order = allocate(count, sizeof(size_t)), .start = allocate(count + 1, sizeof(size_t))};
  struct NeighbourSet *sets = neighbours_of(count, positions, position_count);
  size_t *index = allocate(count, sizeof *index), *end = allocate(count, sizeof *end);
  eliminate_rows(graph, count, rank, sets, result.order, index);
  for (size_t i = 0; i < count; i++)
    for (size_t k = 0; k < sets[i].count; k++) result.start[index[sets[i].items[k]] + 1]++;
  for (size_t i = 0; i < count; i++) {
    end[i] = result.start[i];
    result.start[i + 1] += result.start[i] + 1;
  }
  result.column = allocate(result.start[count], sizeof(size_t));
  for (size_t column = 0; column < count; column++) {
    const struct NeighbourSet *set = &sets[result.order[column]];
    for (size_t k = 0; k < set->count; k++) result.column[end[index[set->items[k]]]++] = column;
    result.column[end[column]++] = column;
  }
  return result;
}
