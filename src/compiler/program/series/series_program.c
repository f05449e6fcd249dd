/*
 * Taylor series of the implicit equations of motion, M(t) a(t) = b(t). With M and b expanded about the present time,
 * the coefficient k of the accelerations solves
 *
 *     M_0 a_k = b_k - sum over l = 1 .. k of M_l a_(k-l),
 *
 * and the state follows from v_(k+1) = a_k / (k + 1), q_(k+1) = v_k / (k + 1). M_0 is factored once a step, and its
 * factors serve all orders. An order costs its recurrences and one solution; only elements of M that change in time
 * take part in the sum. A. Jorba, M. Zou: A software package for the numerical integration of ODEs by means of
 * high-order Taylor methods, 2005.
 */
#include "program/series/series_program.h"

#include <stdlib.h>

#include "base/memory.h"
#include "program/codegen/regions.h"
#include "program/series/series_builder.h"

/* Finds the nodes that change in time and must be computed. */
static void find_computed(struct SeriesBuilder *builder) {
  struct NeededNodes *needs = builder->needs;
  const struct Cone *cone = needs->cone;
  bool *below = allocate(cone->count, sizeof *below);
  for (size_t i = 0; i < builder->plan->targets.count; i++)
    below[cone_slot(cone, builder->plan->targets.nodes[i])] = true;
  for (size_t i = cone->count; i-- > 0;) {
    Node node = cone->nodes[i];
    if (!below[i] || is_fetched(needs, node)) continue;
    builder->is_computed[node] = true;
    if (is_integrated_power(builder, node)) continue;
    struct FusedOperation fused = fused_operation_of(needs, node);
    below[cone_slot(cone, fused.left)] = true;
    if (fused.arity == 2) below[cone_slot(cone, fused.right)] = true;
  }
  for (size_t i = 0; i < cone->count; i++)
    if (builder->is_computed[cone->nodes[i]]) append_node(&builder->nodes, cone->nodes[i]);
}

static struct SeriesBuilder *builder_create(const struct SeriesPlan *plan, const struct CodeGenerator *generator) {
  size_t size = generator->graph->count;
  struct SeriesBuilder *builder = allocate(1, sizeof *builder);
  *builder = (struct SeriesBuilder){.graph = generator->graph,
                                    .plan = plan,
                                    .coordinates = generator->coordinates,
                                    .generator = generator,
                                    .needs = needs_create(generator->graph),
                                    .order = ir_create(),
                                    .is_computed = allocate(size, sizeof(bool)),
                                    .has_row = allocate(size, sizeof(bool)),
                                    .is_done = allocate(size, sizeof(bool)),
                                    .rate = allocate(size, sizeof(size_t)),
                                    .inverse = allocate(size, sizeof(size_t))};
  needs_collect(builder->needs, plan->targets.nodes, plan->targets.count, false);
  find_computed(builder);
  return builder;
}

static void append_next(struct SeriesBuilder *builder, Node node);

/* Appends the operands first; auxiliary nodes may have higher numbers than the nodes that need them. */
static void append_operands(struct SeriesBuilder *builder, Node node) {
  struct FusedOperation fused = fused_operation_of(builder->needs, node);
  if (!is_integrated_power(builder, node)) {
    append_next(builder, fused.left);
    if (fused.arity == 2) append_next(builder, fused.right);
  }
  enum Operation operation = builder->graph->vertices[node].operation;
  if (operation == POWER || operation == MINIMUM || operation == MAXIMUM)
    append_next(builder, builder->plan->auxiliary[node]);
}

static void append_next(struct SeriesBuilder *builder, Node node) {
  if (!builder->is_computed[node] || builder->is_done[node]) return;
  builder->is_done[node] = true;
  append_operands(builder, node);
  append_recurrence(builder, node);
  /* sine and cosine of one argument need each other's coefficients below k */
  enum Operation operation = builder->graph->vertices[node].operation;
  if (operation == SINE || operation == COSINE || operation == SINH || operation == COSH)
    append_next(builder, builder->plan->auxiliary[node]);
}

static bool has_accelerations(const struct SeriesBuilder *builder, Node node) {
  return graph_depends_on(builder->graph, node, ACCELERATION);
}

static void append_nodes_of_order(struct SeriesBuilder *builder) {
  for (size_t i = 0; i < builder->nodes.count; i++) append_next(builder, builder->nodes.nodes[i]);
}

/* Appends the nodes that do not depend on accelerations of factored blocks, which are not known yet. */
static void append_nodes_before_blocks(struct SeriesBuilder *builder) {
  for (size_t i = 0; i < builder->nodes.count; i++)
    if (!has_accelerations(builder, builder->nodes.nodes[i])) append_next(builder, builder->nodes.nodes[i]);
}

static Slot acceleration_row(size_t coordinate) {
  return slot_at((enum Space)SPACE_OF_ACCELERATIONS, coordinate);
}

/* An element of M that changes in time. */
struct ChangingMass {
  struct Position at;
  Node mass;
};

/* Returns the elements of a block that change in time, of both triangles, sorted by columns. */
static struct ChangingMass *changing_masses(const struct SeriesBuilder *builder, const struct InertiaBlock *block,
                                            size_t *count) {
  struct ChangingMass *masses = allocate(2 * block->start[block->count], sizeof *masses);
  *count = 0;
  for (size_t i = 0; i < block->count; i++)
    for (size_t e = block->start[i]; e < block->start[i + 1]; e++) {
      size_t j = block->column[e];
      if (is_constant_series(builder, block->mass[e])) continue;
      masses[(*count)++] = (struct ChangingMass){{i, j}, block->mass[e]};
      if (i != j) masses[(*count)++] = (struct ChangingMass){{j, i}, block->mass[e]};
    }
  qsort(masses, *count, sizeof *masses, compare_positions);
  return masses;
}

/* Appends sum - (M_ij a_j)_k without the term with a_k, which is solved for. */
static Slot append_rest(struct SeriesBuilder *builder, Slot sum, Node mass, size_t coordinate) {
  Slot rest = slot_at((enum Space)SPACE_OF_FACTORS, builder->factor_count++);
  ir_append(builder->order, SERIES_REST, rest, sum, series_row(builder, mass), acceleration_row(coordinate));
  return rest;
}

/* Appends M_0 a_k = b_k - sum over l of M_l a_(k-l) for one block. */
static void append_block(struct SeriesBuilder *builder, const struct Equations *equations,
                         const struct LoopedBlock *looped, size_t number) {
  const struct InertiaBlock *block = looped->block;
  size_t mass_count;
  const struct ChangingMass *masses = changing_masses(builder, block, &mass_count), *next = masses;
  for (size_t i = 0; i < block->count; i++) {
    Slot sum = series_coefficient(builder, equations->right_side[block->coordinates[i]]);
    for (; next < masses + mass_count && next->at.column == i; next++)
      sum = append_rest(builder, sum, next->mass, block->coordinates[next->at.row]);
    for (size_t k = 0; k < block->force_count; k++) {
      Node nonsymmetric = block->nonsymmetric[k * block->count + i];
      if (!is_constant_series(builder, nonsymmetric))
        sum = append_rest(builder, sum, nonsymmetric, block->coordinates[block->forces[k]]);
    }
    ir_append(builder->order, SERIES_COPY, slot_at(SPACE_RIGHT_SIDE, looped->first_right_side + i), sum, 0, 0);
  }
  ir_append(builder->order, SERIES_SOLVE, (Slot)number, 0, 0, 0);
  for (size_t i = 0; i < block->count; i++)
    ir_append(builder->order, SERIES_COPY, acceleration_row(block->coordinates[i]),
              slot_at(SPACE_RIGHT_SIDE, looped->first_right_side + i), 0, 0);
}

static void append_state(struct SeriesBuilder *builder, size_t state, Slot derivative) {
  ir_append(builder->order, SERIES_STATE, slot_at(SPACE_STATE_ROW, state), derivative, 0, 0);
}

/* Appends the coefficients k + 1 of the state from the coefficients k of its derivative. */
static void append_states(struct SeriesBuilder *builder, const struct Equations *equations) {
  size_t n = equations->count;
  for (size_t i = 0; i < n; i++) {
    append_state(builder, i, slot_at(SPACE_STATE_ROW, n + i));
    append_state(builder, n + i, series_coefficient(builder, equations->acceleration[i]));
  }
  for (size_t i = 0; i < equations->rates.count; i++)
    append_state(builder, 2 * n + i, series_coefficient(builder, equations->rates.nodes[i]));
}

/* Maps slots in the provisional spaces SPACE_OF_... (series_builder.h) to final slots: rows and local variables. */
struct Rows {
  const struct SeriesBuilder *builder;
  size_t *row; /* for each node with has_row of the builder: its row */
  size_t acceleration_row, further_row;
  struct IrFunction *order;
  Slot *local; /* for each node with has_local: its local variable */
  bool *has_local;
  Slot *factor; /* of each local variable that belongs to no node; 0: not assigned yet */
};

static Slot resolved(struct Rows *rows, Slot slot) {
  size_t index = index_in(slot);
  switch ((int)space_of(slot)) {
  case SPACE_OF_NODES:
    if (rows->builder->has_row[index]) return slot_at(SPACE_ROW, rows->row[index]);
    if (!rows->has_local[index]) rows->local[index] = ir_new_local(rows->order);
    rows->has_local[index] = true;
    return rows->local[index];
  case SPACE_OF_ACCELERATIONS: return slot_at(SPACE_ROW, rows->acceleration_row + index);
  case SPACE_OF_RATES: return slot_at(SPACE_ROW, rows->further_row + index);
  case SPACE_OF_FACTORS:
    if (rows->factor[index] == 0) rows->factor[index] = ir_new_local(rows->order);
    return rows->factor[index];
  default: return slot;
  }
}

/*
 * Dead-code elimination: returns which instructions have an effect. Nodes whose coefficients nothing reads have none,
 * such as an argument that is linear in time.
 */
static bool *find_used(const struct SeriesBuilder *builder) {
  const struct IrFunction *open = builder->order;
  bool *is_used = allocate(open->count, sizeof *is_used);
  bool *is_read = allocate(builder->graph->count, sizeof *is_read);
  for (size_t i = open->count; i-- > 0;) {
    const struct Instruction *instruction = &open->instructions[i];
    bool of_node = instruction->opcode != SERIES_SOLVE && (int)space_of(instruction->result) == SPACE_OF_NODES;
    size_t node = index_in(instruction->result);
    is_used[i] = !of_node || builder->has_row[node] || is_read[node];
    for (int j = 0; j < opcode_arity(instruction->opcode) && is_used[i]; j++)
      if ((int)space_of(instruction->operands[j]) == SPACE_OF_NODES) is_read[index_in(instruction->operands[j])] = true;
  }
  return is_used;
}

/* Returns the instructions of an order with final slots. */
static struct IrFunction *resolve(struct Rows *rows) {
  const struct IrFunction *open = rows->builder->order;
  bool *is_used = find_used(rows->builder);
  rows->order = ir_create();
  for (size_t i = 0; i < open->count; i++) {
    const struct Instruction *from = &open->instructions[i];
    if (!is_used[i]) continue;
    Slot operands[OPERAND_LIMIT] = {0};
    for (int j = 0; j < opcode_arity(from->opcode); j++) operands[j] = resolved(rows, from->operands[j]);
    Slot result = from->opcode == SERIES_SOLVE ? from->result : resolved(rows, from->result);
    ir_append(rows->order, from->opcode, result, operands[0], operands[1], operands[2]);
  }
  release(is_used);
  return rows->order;
}

/* Assigns rows to the nodes that need them, then to accelerations, factors of K, time derivatives and inverses. */
static struct Rows rows_create(const struct SeriesBuilder *builder, size_t accelerations, size_t mass_count,
                               struct SeriesProgram *program) {
  size_t size = builder->graph->count, count = 0;
  struct Rows rows = {.builder = builder,
                      .row = allocate(size, sizeof(size_t)),
                      .local = allocate(size, sizeof(Slot)),
                      .has_local = allocate(size, sizeof(bool)),
                      .factor = allocate(builder->factor_count, sizeof(Slot))};
  for (size_t i = 0; i < builder->nodes.count; i++)
    if (builder->has_row[builder->nodes.nodes[i]]) rows.row[builder->nodes.nodes[i]] = count++;
  rows.acceleration_row = program->acceleration_row = count;
  program->acceleration_count = accelerations;
  program->mass_row = count + accelerations;
  rows.further_row = program->mass_row + (mass_count + SERIES_LENGTH - 1) / SERIES_LENGTH;
  program->row_count = rows.further_row + builder->further_rows;
  return rows;
}

/* Returns the conditions under which rows are needed; the runtime reads the rows of accelerations. */
static Slot *row_conditions_of(const struct SeriesProgram *program) {
  Slot *conditions = regions_rows_create(program->row_count);
  for (size_t i = 0; i < program->acceleration_count; i++)
    regions_need_row(conditions, program->acceleration_row + i, NULL);
  for (size_t i = 0; i < program->limit.count; i++) {
    const struct LimitCheck *check = &program->limit.items[i];
    const Slot rows[] = {check->row, check->other_row}, *condition = check->is_guarded ? &check->guard_condition : NULL;
    for (int j = 0; j < (limit_metadata(check->rule)->has_two_rows ? 2 : 1); j++)
      if (space_of(rows[j]) == SPACE_ROW) regions_need_row(conditions, index_in(rows[j]), condition);
  }
  regions_find_rows(program->order, conditions, program->row_count);
  return conditions;
}

/* Sets the program's instructions of an order, counts its recurrences, and resolves the slots of the step limits. */
static void complete(struct SeriesProgram *program, struct Rows *rows) {
  program->order = resolve(rows);
  for (size_t i = 0; i < program->order->count; i++)
    program->recurrences += opcode_metadata(program->order->instructions[i].opcode)->is_recurrence;
  for (size_t i = 0; i < program->limit.count; i++) {
    program->limit.items[i].row = resolved(rows, program->limit.items[i].row);
    program->limit.items[i].other_row = resolved(rows, program->limit.items[i].other_row);
  }
  program->order->row_conditions = row_conditions_of(program);
}

/* Begins the function that computes the coefficients 0 of the rows. */
static struct IrFunction *begin_start(const struct SeriesProgram *program, struct CodeGenerator *generator) {
  struct IrFunction *start = generator_begin(generator);
  start->row_conditions = program->order->row_conditions;
  return start;
}

/* Computes the nodes that have rows and do not depend on accelerations. */
static void compute_before_blocks(const struct SeriesBuilder *builder, struct CodeGenerator *generator) {
  struct NodeList targets = {0};
  for (size_t i = 0; i < builder->nodes.count; i++) {
    Node node = builder->nodes.nodes[i];
    if (builder->has_row[node] && !has_accelerations(builder, node)) append_node(&targets, node);
  }
  generator_compute(generator, targets.nodes, targets.count, false);
}

/* Computes the nodes that have rows, and further nodes. */
static void compute_first(const struct SeriesBuilder *builder, struct CodeGenerator *generator, const Node *further,
                          size_t count) {
  struct NodeList targets = {0};
  append_nodes(&targets, further, count);
  for (size_t i = 0; i < builder->nodes.count; i++)
    if (builder->has_row[builder->nodes.nodes[i]]) append_node(&targets, builder->nodes.nodes[i]);
  generator_compute(generator, targets.nodes, targets.count, false);
}

/* Copies coefficient 0 of all rows, and computes the inverses. */
static void copy_first(const struct Rows *rows, struct CodeGenerator *generator) {
  const struct SeriesBuilder *builder = rows->builder;
  for (size_t i = 0; i < builder->nodes.count; i++) {
    Node node = builder->nodes.nodes[i];
    if (builder->has_row[node]) generator_copy(generator, slot_at(SPACE_ROW, rows->row[node]), node);
  }
  for (size_t i = 0; i < builder->needs->cone->count; i++) {
    Node node = builder->needs->cone->nodes[i];
    if (builder->inverse[node] == 0) continue;
    Slot row = slot_at(SPACE_ROW, rows->further_row + builder->inverse[node] - 1);
    ir_append(generator->ir, RECIPROCAL, row, generator_slot(generator, node), 0, 0);
  }
}

/* Frees what only the construction of a program needs. */
static void release_construction(struct SeriesBuilder *builder, const struct Rows *rows) {
  release(rows->row);
  release(rows->local);
  release(rows->has_local);
  release(rows->factor);
  needs_release(builder->needs);
  release(builder->order->instructions);
  release(builder->order);
  release(builder->nodes.nodes);
  release(builder->is_computed);
  release(builder->has_row);
  release(builder->is_done);
  release(builder->rate);
  release(builder->inverse);
  release(builder);
}

struct SeriesProgram *series_program_of_motion(const struct Expressions *expressions, const struct LoopedBlocks *blocks,
                                               struct CodeGenerator *generator) {
  const struct Equations *equations = expressions->equations;
  size_t n = equations->count;
  struct SeriesProgram *program = allocate(1, sizeof *program);
  struct SeriesBuilder *builder = builder_create(expressions->series, generator);
  program->limit = limits_of(builder);
  append_nodes_before_blocks(builder);
  for (size_t i = 0; i < blocks->count; i++) append_block(builder, equations, &blocks->items[i], i);
  append_nodes_of_order(builder);
  append_states(builder, equations);
  struct Rows rows = rows_create(builder, blocks->count > 0 ? row_count(equations) : 0, blocks->mass_count, program);
  complete(program, &rows);

  program->start = begin_start(program, generator);
  compute_before_blocks(builder, generator);
  append_accelerations(generator, equations, blocks, false);
  define_unknowns(generator, equations, blocks, expressions->unknowns);
  compute_first(builder, generator, equations->rates.nodes, equations->rates.count);
  copy_first(&rows, generator);
  for (size_t i = 0; i < n; i++) ir_copy(program->start, target_slot(i), slot_at(SPACE_STATE, n + i));
  for (size_t b = 0; b < blocks->count; b++) {
    const struct LoopedBlock *looped = &blocks->items[b];
    for (size_t i = 0; i < looped->block->count; i++)
      ir_copy(program->start, slot_at(SPACE_ROW, rows.acceleration_row + looped->block->coordinates[i]),
              slot_at(SPACE_RIGHT_SIDE, looped->first_right_side + i));
  }
  for (size_t i = 0; i < equations->rates.count; i++)
    generator_copy(generator, target_slot(2 * n + i), equations->rates.nodes[i]);
  release_construction(builder, &rows);
  return program;
}

static bool uses_accelerations(const struct SeriesPlan *plan, const struct Graph *graph) {
  for (size_t i = 0; i < plan->targets.count; i++)
    if (graph_depends_on(graph, plan->targets.nodes[i], ACCELERATION)) return true;
  return false;
}

struct SeriesProgram *series_program_of_outputs(const struct Expressions *expressions,
                                                struct CodeGenerator *generator) {
  const struct SeriesPlan *plan = expressions->output_series;
  size_t count = expressions->model->outputs.count, n = expressions->equations->count;
  struct SeriesProgram *program = allocate(1, sizeof *program);
  struct SeriesBuilder *builder = builder_create(plan, generator);
  bool with_accelerations = uses_accelerations(plan, generator->graph);
  for (size_t i = 0; with_accelerations && i < n; i++)
    ir_append(builder->order, SERIES_SLOPE, acceleration_row(i), slot_at(SPACE_STATE_ROW, n + i), 0, 0);
  append_nodes_of_order(builder);
  for (size_t i = 0; i < count; i++)
    ir_append(builder->order, SERIES_COPY, slot_at(SPACE_TARGET_ROW, i),
              series_coefficient(builder, expressions->result[i]), 0, 0);
  struct Rows rows = rows_create(builder, with_accelerations ? n : 0, 0, program);
  complete(program, &rows);

  program->start = begin_start(program, generator);
  for (size_t i = 0; with_accelerations && i < n; i++) {
    Slot acceleration = slot_at(SPACE_ACCELERATION, i);
    ir_append(program->start, FIRST_SLOPE, acceleration, slot_at(SPACE_STATE_ROW, n + i), 0, 0);
    ir_copy(program->start, slot_at(SPACE_ROW, rows.acceleration_row + i), acceleration);
  }
  compute_first(builder, generator, expressions->result, count);
  copy_first(&rows, generator);
  for (size_t i = 0; i < count; i++) generator_copy(generator, slot_at(SPACE_TARGET_ROW, i), expressions->result[i]);
  release_construction(builder, &rows);
  return program;
}

struct SeriesProgram *series_program_of_watched(const struct Expressions *expressions,
                                                struct CodeGenerator *generator) {
  const struct SeriesPlan *plan = expressions->watched_series;
  struct SeriesProgram *program = allocate(1, sizeof *program);
  struct SeriesBuilder *builder = builder_create(plan, generator);
  size_t forces = uses_accelerations(plan, generator->graph) ? row_count(expressions->equations) : 0;
  program->limit = limits_of(builder);
  /* Nodes that no limit needs have no row. */
  for (size_t i = 0; i < builder->nodes.count; i++)
    if (builder->has_row[builder->nodes.nodes[i]]) append_next(builder, builder->nodes.nodes[i]);
  struct Rows rows = rows_create(builder, forces, 0, program);
  complete(program, &rows);

  program->start = begin_start(program, generator);
  compute_first(builder, generator, NULL, 0);
  copy_first(&rows, generator);
  for (size_t i = 0; i < forces; i++)
    ir_copy(program->start, slot_at(SPACE_ROW, rows.acceleration_row + i), slot_at(SPACE_ACCELERATION, i));
  release_construction(builder, &rows);
  return program->limit.count > 0 ? program : NULL;
}
