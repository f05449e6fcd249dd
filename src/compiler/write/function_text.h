/* The functions of the generated code, which both writers write. */
#ifndef FUNCTION_TEXT_H
#define FUNCTION_TEXT_H

#include <stdio.h>

#include "program/program.h"

enum Returned { RETURNS_NOTHING, RETURNS_STATUS, RETURNS_VALUE };

/* Where a function finds or leaves accelerations. */
enum Accelerations { IN_WORKSPACE, IN_TARGET, IN_ARGUMENT };

struct FunctionText {
  const char *comment, *name;
  const char *arguments; /* as declared */
  const char *target;    /* the argument that it fills; NULL where a value is returned */
  enum Returned returned;
  enum Accelerations accelerations;
};

extern const struct FunctionText prepare_text, initial_state_text, initial_state_along_text, derivatives_text,
    directional_text, jacobian_text, linear_text, accelerations_text, accelerations_along_text, correct_positions_text,
    correct_velocities_text, respond_text, start_positions_text, start_velocities_text, start_text, result_text,
    results_text, result_along_text, indicators_text, switching_values_text, series_text, output_series_text,
    limit_text;

/* The comment and the head of a function, up to its brace; suffix belongs to the name. */
void write_head(FILE *file, const struct FunctionText *text, const char *suffix, size_t operations);

#endif
