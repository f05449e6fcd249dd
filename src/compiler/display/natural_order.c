#include "display/natural_order.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "display/products.h"

enum TermClass { OF_ACCELERATION, QUADRATIC_IN_VELOCITIES, LINEAR_IN_VELOCITIES, WITHOUT_VELOCITIES, OF_INPUTS };

/* A term, or several that are shown as one product, with what its place depends on. */
struct Piece {
  struct Term term; /* without the factors that its text collects */
  enum TermClass class;
  char *text; /* without the sign */
  bool is_negative;
};

struct Pieces {
  const struct Atoms *atoms;
  const char *const *texts;
  struct Piece *items;
  size_t count;
};

static bool is_of_parameters(const struct Atoms *atoms, int atom) {
  return factor_rank(atoms, atoms->nodes[atom]) <= RANK_PARAMETER;
}

static enum TermClass class_of(const struct Atoms *atoms, const struct Term *term) {
  double velocities = 0.0;
  bool of_acceleration = false, of_input = false;
  for (int k = 0; k < atoms->count; k++) {
    if (term->exponents[k] == 0.0) continue;
    of_acceleration |= graph_depends_on(atoms->graph, atoms->nodes[k], ACCELERATION);
    of_input |= graph_depends_on(atoms->graph, atoms->nodes[k], INPUT);
    if (graph_depends_on(atoms->graph, atoms->nodes[k], VELOCITY)) velocities += fabs(term->exponents[k]);
  }
  if (of_acceleration) return OF_ACCELERATION;
  if (of_input) return OF_INPUTS;
  return velocities >= 2.0 ? QUADRATIC_IN_VELOCITIES : velocities > 0.0 ? LINEAR_IN_VELOCITIES : WITHOUT_VELOCITIES;
}

/* Returns the rank of an atom for the order of terms: lower ones decide first. */
static int order_rank(const struct Atoms *atoms, int atom) {
  static const int ranks[] = {
      [RANK_PARAMETER_SUM] = 9, [RANK_PARAMETER] = 8,  [RANK_MODE] = 7,  [RANK_INPUT] = 2,
      [RANK_TIME] = 5,          [RANK_COORDINATE] = 3, [RANK_STATE] = 4, [RANK_VELOCITY] = 1,
      [RANK_NAMED] = 5,         [RANK_FUNCTION] = 6,   [RANK_SUM] = 6,   [RANK_ACCELERATION] = 0};
  return ranks[factor_rank(atoms, atoms->nodes[atom])];
}

static double parameter_degree(const struct Atoms *atoms, const struct Term *term) {
  double degree = 0.0;
  for (int k = 0; k < atoms->count; k++) degree += fabs(term->exponents[k]);
  return degree;
}

/* Returns true if term a stands before b, both of one class. */
static bool stands_before(const struct Atoms *atoms, const struct Term *a, const struct Term *b) {
  int best = -1;
  bool of_parameters = true;
  for (int k = 0; k < atoms->count; k++) {
    of_parameters = of_parameters && (a->exponents[k] == 0.0 || is_of_parameters(atoms, k)) &&
                    (b->exponents[k] == 0.0 || is_of_parameters(atoms, k));
    if (a->exponents[k] == b->exponents[k]) continue;
    int rank = order_rank(atoms, k), other = best >= 0 ? order_rank(atoms, best) : 0;
    if (best < 0 || rank < other || (rank == other && atoms->nodes[k] < atoms->nodes[best])) best = k;
  }
  double degrees[] = {parameter_degree(atoms, a), parameter_degree(atoms, b)};
  if (of_parameters && degrees[0] != degrees[1]) return degrees[0] < degrees[1];
  return best >= 0 && a->exponents[best] > b->exponents[best];
}

static bool is_in_front(const struct Atoms *atoms, const struct Piece *a, const struct Piece *b) {
  if (a->class != b->class) return a->class < b->class;
  return stands_before(atoms, &a->term, &b->term);
}

static void sort_pieces(const struct Atoms *atoms, struct Piece *pieces, size_t count) {
  for (size_t i = 1; i < count; i++) {
    struct Piece piece = pieces[i];
    size_t k = i;
    for (; k > 0 && is_in_front(atoms, &piece, &pieces[k - 1]); k--) pieces[k] = pieces[k - 1];
    pieces[k] = piece;
  }
}

/* Joins pieces to a sum. A positive one comes first if there is one, but accelerations stay where they are. */
static char *joined_text(struct Piece *pieces, size_t count) {
  size_t first = 0;
  while (first < count && pieces[first].is_negative && pieces[first].class != OF_ACCELERATION) first++;
  if (first < count) {
    struct Piece piece = pieces[first];
    memmove(pieces + 1, pieces, first * sizeof *pieces);
    pieces[0] = piece;
  }
  struct TextStream text;
  FILE *file = open_text(&text);
  for (size_t i = 0; i < count; i++) {
    fputs(pieces[i].is_negative ? (i == 0 ? "-" : " - ") : (i == 0 ? "" : " + "), file);
    fputs(pieces[i].text, file);
  }
  if (count == 0) fputs("0", file);
  return close_text(&text);
}

/* Returns the number by which the coefficients are divided: the least of them, if all others are multiples. */
static double common_number(const struct Term *terms, size_t count) {
  double least = terms[0].coefficient;
  for (size_t i = 1; i < count; i++)
    if (fabs(terms[i].coefficient) < fabs(least)) least = terms[i].coefficient;
  for (size_t i = 0; i < count; i++) {
    double ratio = terms[i].coefficient / least;
    if (fabs(ratio - round(ratio)) > 1e-14 * fabs(ratio)) return 1.0;
  }
  return fabs(least);
}

/* Divides terms by the powers of atoms that all of them have; returns the product of these. */
static struct Term take_common_atoms(struct Term *terms, size_t count) {
  struct Term common = {.coefficient = 1.0};
  for (int k = 0; k < ATOM_ROOM; k++) {
    common.exponents[k] = terms[0].exponents[k];
    for (size_t i = 1; i < count; i++) common.exponents[k] = fmin(common.exponents[k], terms[i].exponents[k]);
    for (size_t i = 0; i < count; i++) terms[i].exponents[k] -= common.exponents[k];
  }
  return common;
}

static struct Piece piece_of(const struct Atoms *atoms, const struct Term *term, const char *const *texts) {
  return (struct Piece){.term = *term,
                        .class = class_of(atoms, term),
                        .text = product_text(atoms, fabs(term->coefficient), term, texts, NULL),
                        .is_negative = term->coefficient < 0.0};
}

/* Returns terms that differ in parameters alone as one piece: common factors times a sum of parameters. */
static struct Piece collected_parameters(const struct Atoms *atoms, struct Term *terms, size_t count,
                                         const char *const *texts) {
  struct Piece whole = piece_of(atoms, &terms[0], texts);
  if (count == 1) return whole;
  struct Piece *pieces = allocate(count, sizeof *pieces);
  double number = common_number(terms, count);
  struct Term common = take_common_atoms(terms, count);
  bool is_positive = false;
  for (size_t i = 0; i < count; i++) is_positive |= terms[i].coefficient > 0.0;
  for (size_t i = 0; i < count; i++) {
    terms[i].coefficient /= is_positive ? number : -number;
    pieces[i] = piece_of(atoms, &terms[i], texts);
  }
  sort_pieces(atoms, pieces, count);
  whole.text = product_text(atoms, number, &common, texts, joined_text(pieces, count));
  whole.term = common;
  whole.is_negative = !is_positive;
  release(pieces);
  return whole;
}

/* True if the terms have the same atoms but for parameters, and do not consist of these alone. */
static bool differ_in_parameters(const struct Atoms *atoms, const struct Term *a, const struct Term *b) {
  bool has_others = false;
  for (int k = 0; k < atoms->count; k++) {
    bool is_equal = a->exponents[k] == b->exponents[k];
    if ((is_equal && a->exponents[k] == 0.0) || is_of_parameters(atoms, k)) continue;
    if (!is_equal) return false;
    has_others = true;
  }
  return has_others;
}

/* Collects the terms into pieces. */
static void collect_parameters(struct Pieces *pieces, const struct Terms *terms) {
  const struct Atoms *atoms = pieces->atoms;
  bool done[TERM_ROOM] = {false};
  struct Term *alike = allocate(terms->count, sizeof *alike);
  for (size_t i = 0; i < terms->count; i++) {
    if (done[i]) continue;
    size_t count = 0;
    for (size_t j = i; j < terms->count; j++) {
      if (done[j] || (j > i && !differ_in_parameters(atoms, &terms->items[i], &terms->items[j]))) continue;
      done[j] = true;
      alike[count++] = terms->items[j];
    }
    pieces->items[pieces->count++] = collected_parameters(atoms, alike, count, pieces->texts);
  }
  release(alike);
}

/* Returns the index of the only acceleration of a term, to the first power; -1 for other terms. */
static int acceleration_of(const struct Atoms *atoms, const struct Term *term) {
  int found = -1;
  for (int k = 0; k < atoms->count; k++) {
    if (term->exponents[k] == 0.0 || !graph_depends_on(atoms->graph, atoms->nodes[k], ACCELERATION)) continue;
    if (found >= 0 || term->exponents[k] != 1.0) return -1;
    found = k;
  }
  return found;
}

/* Returns the terms that contain the acceleration, without it; marks them as done. */
static struct Terms coefficients_of(const struct Atoms *atoms, const struct Terms *terms, int acceleration,
                                    bool *done) {
  struct Terms found = {allocate(terms->count, sizeof *found.items), 0};
  for (size_t i = 0; i < terms->count; i++) {
    if (done[i] || acceleration_of(atoms, &terms->items[i]) != acceleration) continue;
    done[i] = true;
    found.items[found.count] = terms->items[i];
    found.items[found.count++].exponents[acceleration] = 0.0;
  }
  return found;
}

/* Returns room for this number of pieces; sum_with_terms() releases it. */
static struct Pieces create_pieces(const struct Atoms *atoms, const char *const *texts, size_t room) {
  return (struct Pieces){.atoms = atoms, .texts = texts, .items = allocate(room, sizeof(struct Piece))};
}

/* Returns the sum of the pieces and of further terms, which are collected by parameters; releases the pieces. */
static char *sum_with_terms(struct Pieces *pieces, const struct Terms *terms) {
  collect_parameters(pieces, terms);
  sort_pieces(pieces->atoms, pieces->items, pieces->count);
  char *text = joined_text(pieces->items, pieces->count);
  release(pieces->items);
  return text;
}

/* Returns the terms of one acceleration as a piece. */
static struct Piece collected_acceleration(const struct Atoms *atoms, struct Terms *coefficients, int acceleration,
                                           const char *const *texts) {
  struct Piece whole = {.class = OF_ACCELERATION};
  struct Term common = take_common_atoms(coefficients->items, coefficients->count);
  bool is_negative = true;
  for (size_t i = 0; i < coefficients->count; i++) is_negative &= coefficients->items[i].coefficient < 0.0;
  for (size_t i = 0; i < coefficients->count && is_negative; i++) coefficients->items[i].coefficient *= -1.0;
  common.exponents[acceleration] = 1.0;
  double number = common_number(coefficients->items, coefficients->count);
  for (size_t i = 0; i < coefficients->count; i++) coefficients->items[i].coefficient /= number;
  struct Pieces pieces = create_pieces(atoms, texts, coefficients->count);
  char *text = sum_with_terms(&pieces, coefficients);
  whole.text = product_text(atoms, number, &common, texts, text);
  whole.term.exponents[acceleration] = 1.0;
  whole.is_negative = is_negative;
  return whole;
}

char *sum_in_natural_order(const struct Atoms *atoms, const struct Terms *terms, const char *const *texts) {
  struct Pieces pieces = create_pieces(atoms, texts, terms->count);
  bool done[TERM_ROOM] = {false};
  struct Terms rest = {allocate(terms->count, sizeof *rest.items), 0};
  for (size_t i = 0; i < terms->count; i++) {
    int acceleration = acceleration_of(atoms, &terms->items[i]);
    if (done[i]) continue;
    if (acceleration < 0) {
      rest.items[rest.count++] = terms->items[i];
      continue;
    }
    struct Terms coefficients = coefficients_of(atoms, terms, acceleration, done);
    if (coefficients.count > 1)
      pieces.items[pieces.count++] = collected_acceleration(atoms, &coefficients, acceleration, texts);
    else rest.items[rest.count++] = terms->items[i];
    release(coefficients.items);
  }
  char *text = sum_with_terms(&pieces, &rest);
  release(rest.items);
  return text;
}
