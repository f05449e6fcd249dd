/*
 * A condition depends on the signs of indicators, and on modes and Booleans by themselves, in short on atoms.
 * Indicators that are r u + c with numbers r and c, such as those of u > 1 and u < -1, belong to one line, that of
 * u. The zeros of its indicators divide a line into points and intervals. In a cell of the product of all lines no
 * atom changes its sign. So the condition has one value there, by interval arithmetic (bounds.h).
 *
 * A condition with the same value in all cells has one outcome. Cells outside of the bounds of u do not count. A motion
 * need not come to all other cells, so that some conditions with one outcome are not found.
 */
#include "read/condition_outcomes.h"

#include <math.h>
#include <stdlib.h>

#include "algebra/cone.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "read/bounds.h"

/* Largest number of cells: those of eight comparisons of different quantities. */
enum { CELL_LIMIT = 6561 };

/* Relative difference of numbers that are equal but for rounding errors. */
static const double rounding = 1e-12;

/* A sum of numbers times different nodes, and a number. Invariant: the nodes ascend. */
struct LinearForm {
  Node *nodes;
  double *coefficients;
  size_t count;
  double constant;
};

struct Atom {
  Node node;      /* in the condition */
  Node indicator; /* the atom has its sign */
  size_t line;
  double factor, zero; /* the indicator is factor (u - zero) */
};

/* Values of u. Cell 2 k is the interval before the zero k, and 2 k + 1 this zero. */
struct Line {
  struct LinearForm form; /* u */
  Node u;
  double *zeros; /* ascending */
  size_t zero_count;
  bool *has_cell; /* [2 zero_count + 1] */
  size_t cell;    /* the present one */
};

struct Analysis {
  const struct Model *model;
  Node condition;
  struct Atom *atoms;
  size_t atom_count;
  struct Line *lines;
  size_t line_count;
};

/* --- Linear forms --- */

static void add_to_form(struct LinearForm *form, Node node, double coefficient) {
  size_t slot = 0;
  while (slot < form->count && form->nodes[slot] < node) slot++;
  if (slot < form->count && form->nodes[slot] == node) {
    form->coefficients[slot] += coefficient;
    return;
  }
  form->nodes = make_room(form->nodes, form->count, sizeof *form->nodes);
  form->coefficients = make_room(form->coefficients, form->count, sizeof *form->coefficients);
  for (size_t i = form->count; i > slot; i--) {
    form->nodes[i] = form->nodes[i - 1];
    form->coefficients[i] = form->coefficients[i - 1];
  }
  form->nodes[slot] = node;
  form->coefficients[slot] = coefficient;
  form->count++;
}

/* Adds factor times a node. Sums are at most as deep as parentheses, whose number is limited. */
static void add_node(const struct Graph *graph, struct LinearForm *form, Node node, double factor) {
  Node base;
  factor *= coefficient_of(graph, node, &base);
  const struct Vertex *vertex = &graph->vertices[base];
  if (base == ONE) form->constant += factor;
  else if (vertex->operation == ADD) {
    add_node(graph, form, vertex->left, factor);
    add_node(graph, form, vertex->right, factor);
  } else add_to_form(form, base, factor);
}

/* Finds factor and zero with form = factor (u - zero). False if there are none. */
static bool is_on_line(const struct LinearForm *form, const struct LinearForm *u, double *factor, double *zero) {
  if (form->count != u->count || u->count == 0 || u->coefficients[0] == 0.0) return false;
  *factor = form->coefficients[0] / u->coefficients[0];
  if (*factor == 0.0 || !isfinite(*factor)) return false;
  for (size_t i = 0; i < u->count; i++) {
    double expected = *factor * u->coefficients[i];
    if (form->nodes[i] != u->nodes[i] || fabs(form->coefficients[i] - expected) > rounding * fabs(expected))
      return false;
  }
  *zero = u->constant - form->constant / *factor;
  return true;
}

/* --- Atoms and lines --- */

/* Returns the indicator of a branch, by its mode; ZERO for other nodes. */
static Node indicator_of_mode(const struct Model *model, Node node) {
  const struct Branch *branch = branch_with_mode(&model->switches, node);
  return branch != NULL ? branch->indicator : ZERO;
}

/* True for a mode or a Boolean parameter. */
static bool is_truth(const struct Model *model, Node node) {
  const struct Symbol *symbol = graph_symbol_of(model->graph, node);
  bool is_flag = symbol->kind == PARAMETER && model->parameters.items[symbol->index].type == TYPE_BOOLEAN;
  return symbol->kind == MODE || is_flag;
}

/* Appends an atom, and its line if it is new. */
static void append_atom(struct Analysis *analysis, Node node, Node indicator) {
  struct LinearForm form = {0};
  struct Atom atom = {.node = node, .indicator = indicator};
  add_node(analysis->model->graph, &form, indicator, 1.0);
  while (atom.line < analysis->line_count &&
         !is_on_line(&form, &analysis->lines[atom.line].form, &atom.factor, &atom.zero))
    atom.line++;
  if (atom.line == analysis->line_count) {
    APPEND(analysis->lines, analysis->line_count, (struct Line){.form = form, .u = indicator});
    atom.factor = 1.0;
  }
  APPEND(analysis->atoms, analysis->atom_count, atom);
}

/* How a node occurs in the condition: its sign alone counts, or its value. */
enum { UNUSED, AS_TRUTH, AS_VALUE };

/*
 * Appends the atoms of the condition, and the lines. Operands follow what uses them, as a cone is in topological order.
 */
static void find_atoms(struct Analysis *analysis) {
  const struct Model *model = analysis->model;
  const struct Graph *graph = model->graph;
  struct Cone *cone = graph->cone;
  cone_collect(cone, graph, &analysis->condition, 1);
  int *use = allocate(cone->count, sizeof *use);
  use[cone_slot(cone, analysis->condition)] = AS_TRUTH;
  for (size_t i = cone->count; i-- > 0;) {
    Node node = cone->nodes[i];
    const struct Vertex *vertex = &graph->vertices[node];
    int arity = operation_arity(vertex->operation);
    Node indicator = vertex->operation == SIGN     ? vertex->left
                     : vertex->operation == SYMBOL ? indicator_of_mode(model, node)
                                                   : ZERO;
    bool is_alone = vertex->operation == SYMBOL && use[i] == AS_TRUTH && is_truth(model, node);
    if (use[i] == UNUSED) continue;
    if (indicator != ZERO) append_atom(analysis, node, indicator);
    else if (is_alone) append_atom(analysis, node, node);
    for (int k = 0; k < arity && indicator == ZERO; k++) {
      int *below = &use[cone_slot(cone, k == 0 ? vertex->left : vertex->right)];
      int next = vertex->operation == GUARD && k == 0 ? AS_TRUTH : AS_VALUE;
      *below = *below > next ? *below : next;
    }
  }
  release(use);
}

static int compare(const void *first, const void *second) {
  double a = *(const double *)first, b = *(const double *)second;
  return (a > b) - (a < b);
}

/* Finds the zeros of a line, and the cells within its bounds. */
static void find_cells(const struct Analysis *analysis, size_t number) {
  struct Line *line = &analysis->lines[number];
  line->zeros = allocate(analysis->atom_count, sizeof *line->zeros);
  for (size_t i = 0; i < analysis->atom_count; i++)
    if (analysis->atoms[i].line == number) line->zeros[line->zero_count++] = analysis->atoms[i].zero;
  qsort(line->zeros, line->zero_count, sizeof *line->zeros, compare);
  size_t count = 0;
  for (size_t i = 0; i < line->zero_count; i++)
    if (count == 0 || line->zeros[i] > line->zeros[count - 1]) line->zeros[count++] = line->zeros[i];
  line->zero_count = count;
  line->has_cell = allocate(2 * count + 1, sizeof *line->has_cell);
  struct Bounds bounds = bounds_of(analysis->model, line->u, NULL, 0);
  for (size_t k = 0; k <= count; k++) {
    bool is_reached = k == 0 || bounds.high > line->zeros[k - 1];
    line->has_cell[2 * k] = is_reached && (k == count || bounds.low < line->zeros[k]);
    if (k < count) line->has_cell[2 * k + 1] = bounds.low <= line->zeros[k] && bounds.high >= line->zeros[k];
  }
}

/* --- Cells --- */

/* Returns the sign of an atom in the present cell of its line. */
static double sign_in_cell(const struct Analysis *analysis, const struct Atom *atom) {
  const struct Line *line = &analysis->lines[atom->line];
  size_t zero = 0;
  while (line->zeros[zero] < atom->zero) zero++;
  size_t at = 2 * zero + 1;
  double side = (line->cell > at) - (line->cell < at);
  return atom->factor < 0.0 ? -side : side;
}

/* Moves to the next cell; false after the last one. */
static bool next_cell(struct Analysis *analysis) {
  for (size_t i = 0; i < analysis->line_count; i++) {
    struct Line *line = &analysis->lines[i];
    if (line->cell < 2 * line->zero_count) {
      line->cell++;
      return true;
    }
    line->cell = 0;
  }
  return false;
}

static bool is_in_bounds(const struct Analysis *analysis) {
  bool is_in = true;
  for (size_t i = 0; i < analysis->line_count; i++) is_in &= analysis->lines[i].has_cell[analysis->lines[i].cell];
  return is_in;
}

/* Returns the outcome in the present cell. */
static enum Outcome outcome_in_cell(const struct Analysis *analysis, struct KnownBounds *signs) {
  for (size_t i = 0; i < analysis->atom_count; i++) {
    double sign = sign_in_cell(analysis, &analysis->atoms[i]);
    signs[i] = (struct KnownBounds){analysis->atoms[i].node, {sign, sign}};
  }
  struct Bounds bounds = bounds_of(analysis->model, analysis->condition, signs, analysis->atom_count);
  if (bounds.high <= 0.0) return OUTCOME_NEVER;
  return bounds.low > 0.0 ? OUTCOME_ALWAYS : OUTCOME_VARIES;
}

static enum Outcome outcome_in_cells(struct Analysis *analysis) {
  struct KnownBounds *signs = allocate(analysis->atom_count, sizeof *signs);
  enum Outcome outcome = OUTCOME_VARIES;
  bool is_first = true;
  do {
    if (!is_in_bounds(analysis)) continue;
    enum Outcome found = outcome_in_cell(analysis, signs);
    outcome = is_first || found == outcome ? found : OUTCOME_VARIES;
    is_first = false;
  } while ((is_first || outcome != OUTCOME_VARIES) && next_cell(analysis));
  release(signs);
  return outcome;
}

enum Outcome outcome_of(const struct Model *model, Node condition) {
  Node tuned = model->graph->vertices[condition].operation == SYMBOL ? indicator_of_mode(model, condition) : ZERO;
  bool is_of_modes = tuned != ZERO && graph_is_constant_in_time(model->graph, tuned);
  struct Analysis analysis = {.model = model, .condition = is_of_modes ? tuned : condition};
  find_atoms(&analysis);
  double cells = 1.0;
  for (size_t i = 0; i < analysis.line_count; i++) {
    find_cells(&analysis, i);
    cells *= 2.0 * (double)analysis.lines[i].zero_count + 1.0;
  }
  return cells > CELL_LIMIT ? OUTCOME_VARIES : outcome_in_cells(&analysis);
}
