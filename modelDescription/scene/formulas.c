/*
 * Coordinates of joints as linear combinations of parameters, found by sampling. Changing one parameter at a time
 * gives the coefficient of each, by a difference quotient. TRIALS changes of all parameters at once confirm or
 * reject that the coordinate is linear. Costs (parameters + TRIALS) searches for all joints.
 */
#include "formulas.h"

#include <math.h>
#include <stdio.h>

#include "base/memory.h"

/* Largest number of parameters, for the cost; changes that confirm linearity. */
enum { MOST_PARAMETERS = 40, TRIALS = 2 };

/* Coefficients below this are rounding errors. */
static const double NO_MULTIPLE = 1e-9;

/* Returns the change of a parameter: a tenth of its value, 0.1 if that is 0; 0 for integers. */
static double change_of(const struct Model *model, size_t parameter) {
  double start = model->parameters.items[parameter].start;
  return model->parameters.items[parameter].type != TYPE_REAL ? 0.0 : start != 0.0 ? 0.1 * start : 0.1;
}

/* Returns the coordinates of all joints with changed parameters; NULL if a joint does not exist then. */
static double *coordinates_with(const struct Model *model, const struct Connections *connections,
                                const double *changes) {
  struct SampledPositions samples = sample_positions(model, false, changes);
  double *coordinates = allocate(JOINT_COORDINATES * connections->joint_count, sizeof *coordinates);
  for (size_t i = 0; i < connections->joint_count && coordinates != NULL; i++) {
    struct SceneJoint joint = {.of = connections->joints[i].of, .with = connections->joints[i].with};
    if (!find_joint(&samples, &joint)) coordinates = NULL;
    for (int k = 0; k < JOINT_COORDINATES && coordinates != NULL; k++)
      coordinates[JOINT_COORDINATES * i + (size_t)k] = joint.coordinates[k];
  }
  release_positions(&samples);
  return coordinates;
}

/* Finds the coefficient of each parameter in each coordinate, a row each. Returns false if a joint vanishes. */
static bool find_multiples(const struct Model *model, const struct Connections *connections, double *multiples) {
  size_t count = model->parameters.count;
  for (size_t p = 0; p < count; p++) {
    double *changes = allocate(count, sizeof *changes);
    changes[p] = change_of(model, p);
    if (changes[p] == 0.0) continue;
    double *coordinates = coordinates_with(model, connections, changes);
    if (coordinates == NULL) return false;
    for (size_t i = 0; i < JOINT_COORDINATES * connections->joint_count; i++)
      multiples[i * count + p] =
          (coordinates[i] - connections->joints[i / JOINT_COORDINATES].coordinates[i % JOINT_COORDINATES]) / changes[p];
  }
  return true;
}

/* True if the coefficients predict the coordinate, to 1e-7, when all parameters change. */
static bool is_sum(const double *multiples, const double *changes, size_t count, double start, double coordinates) {
  double expected = start, size = fabs(start) + fabs(coordinates);
  for (size_t p = 0; p < count; p++) expected += multiples[p] * changes[p];
  return fabs(coordinates - expected) <= 1e-7 * size;
}

static char *sum_as_text(const struct Model *model, const double *multiples, double start) {
  struct TextStream text;
  FILE *file = open_text(&text);
  double rest = start;
  bool is_first = true;
  for (size_t p = 0; p < model->parameters.count; p++) {
    if (fabs(multiples[p]) < NO_MULTIPLE) continue;
    const struct Variable *parameter = &model->parameters.items[p];
    if (fabs(multiples[p] - 1.0) < NO_MULTIPLE) fprintf(file, "%s%s", is_first ? "" : " + ", parameter->name);
    else fprintf(file, "%s%.9g*%s", is_first ? "" : " + ", multiples[p], parameter->name);
    rest -= multiples[p] * parameter->start;
    is_first = false;
  }
  if (fabs(rest) > 1e-9 * fabs(start)) fprintf(file, " + %.9g", rest);
  char *formula = close_text(&text);
  return is_first ? NULL : formula;
}

char **joint_formulas(const struct Model *model, const struct Connections *connections) {
  size_t count = model->parameters.count, coordinate_count = JOINT_COORDINATES * connections->joint_count;
  char **formulas = allocate(coordinate_count + 1, sizeof *formulas);
  double *multiples = allocate(coordinate_count * count + 1, sizeof *multiples);
  if (connections->joint_count == 0 || count > MOST_PARAMETERS || !find_multiples(model, connections, multiples))
    return formulas;
  bool *holds = allocate(coordinate_count, sizeof *holds);
  for (size_t i = 0; i < coordinate_count; i++) holds[i] = true;
  for (int trial = 0; trial < TRIALS; trial++) {
    double *changes = allocate(count, sizeof *changes);
    for (size_t p = 0; p < count; p++)
      changes[p] = change_of(model, p) * sin(1.0 + 1.7 * (double)(p + 1) * (trial + 1));
    double *coordinates = coordinates_with(model, connections, changes);
    for (size_t i = 0; i < coordinate_count; i++)
      holds[i] &= coordinates != NULL &&
                  is_sum(multiples + i * count, changes, count,
                         connections->joints[i / JOINT_COORDINATES].coordinates[i % JOINT_COORDINATES], coordinates[i]);
  }
  for (size_t i = 0; i < coordinate_count; i++)
    if (holds[i])
      formulas[i] = sum_as_text(model, multiples + i * count,
                                connections->joints[i / JOINT_COORDINATES].coordinates[i % JOINT_COORDINATES]);
  return formulas;
}
