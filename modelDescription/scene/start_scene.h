/* The visible parts of a system at its start values, and the direction from which pictures show them. */
#pragma once

#include "connections.h"
#include "surfaces.h"

/* A parallel projection: the directions in space along the axes of the picture, of length 1. */
struct View {
  double right[3], up[3];
  bool is_in_space; /* neither the plane of x and y nor that of x and z */
};

/* Lists and arrays of values last until the program ends; the samples have no values. */
struct StartScene {
  const struct Model *model;
  struct SampledPositions samples;
  struct Connections connections;
  struct Surfaces surfaces;
  double *values;      /* of all nodes, in SI units, where the constraints are fulfilled if that succeeds */
  double *line_values; /* of the nodes of the lines' graph; NULL without lines */
  struct View view;
};

/* Evaluates the system; time and inputs keep their start values. */
struct StartScene start_scene_of(const struct Model *model);

/*
 * Returns the values of the nodes of the lines' graph at the given values of the model's symbols, or NULL without
 * lines. The given values of the model's nodes are on the constraints.
 */
double *values_of_lines(const struct Model *model, const double *symbols, const double *values);
