#include "write/function_text.h"

const struct FunctionText prepare_text = {"What depends on parameters alone",
                                          "prepare",
                                          "const double *p, double *prepared",
                                          "prepared",
                                          RETURNS_STATUS,
                                          IN_WORKSPACE};
const struct FunctionText initial_state_text = {"Start values that follow from parameters",
                                                "initial_state",
                                                "const struct Point *point, double *state",
                                                "state",
                                                RETURNS_NOTHING,
                                                IN_WORKSPACE};
const struct FunctionText initial_state_along_text = {
    "Start values along a direction",
    "initial_state_along",
    "const struct Point *point, const struct Seed *seed, double *state",
    "state",
    RETURNS_NOTHING,
    IN_WORKSPACE};
const struct FunctionText derivatives_text = {
    "d state / dt", "derivatives",  "const struct Point *point, double *derivative",
    "derivative",   RETURNS_STATUS, IN_TARGET};
const struct FunctionText directional_text = {"d state / dt along a direction",
                                              "directional",
                                              "const struct Point *point, const struct Seed *seed, double *derivative",
                                              "derivative",
                                              RETURNS_STATUS,
                                              IN_WORKSPACE};
const struct FunctionText jacobian_text = {
    "Jacobian matrix", "jacobian", "const struct Point *point, double *values", "values", RETURNS_STATUS, IN_WORKSPACE};
const struct FunctionText linear_text = {
    "A, B and c", "linear",        "const double *p, const double *c, double *matrix",
    "matrix",     RETURNS_NOTHING, IN_WORKSPACE};
const struct FunctionText start_text = {"d state / dt, and the first coefficients of all series",
                                        "start",
                                        "const struct Point *point, double *derivative, Series *restrict w",
                                        "derivative",
                                        RETURNS_STATUS,
                                        IN_TARGET};
const struct FunctionText accelerations_text = {"Accelerations and the forces of constraints",
                                                "accelerations",
                                                "const struct Point *point, double *acceleration",
                                                "acceleration",
                                                RETURNS_STATUS,
                                                IN_WORKSPACE};
const struct FunctionText accelerations_along_text = {
    "The same along a direction",
    "accelerations_along",
    "const struct Point *point, const struct Seed *seed, double *acceleration",
    "acceleration",
    RETURNS_STATUS,
    IN_WORKSPACE};
const struct FunctionText correct_positions_text = {
    "What brings the coordinates back to the constraints",
    "correct_positions",
    "const struct Point *point, const struct Seed *seed, double *correction",
    "correction",
    RETURNS_STATUS,
    IN_WORKSPACE};
const struct FunctionText correct_velocities_text = {"The same of the velocities",
                                                     "correct_velocities",
                                                     "const struct Point *point, double *correction",
                                                     "correction",
                                                     RETURNS_STATUS,
                                                     IN_WORKSPACE};
const struct FunctionText respond_text = {"What impulses of contacts and frictions do",
                                          "respond",
                                          "const struct Point *point, const double *da, double *response",
                                          "response",
                                          RETURNS_STATUS,
                                          IN_WORKSPACE};
const struct FunctionText start_positions_text = {
    "The same where fixed coordinates stay",
    "start_positions",
    "const struct Point *point, const struct Seed *seed, double *correction",
    "correction",
    RETURNS_STATUS,
    IN_WORKSPACE};
const struct FunctionText start_velocities_text = {
    "And of the velocities", "start_velocities", "const struct Point *point, double *correction", "correction",
    RETURNS_STATUS,          IN_WORKSPACE};
const struct FunctionText result_text = {
    "A computed variable", "result", "const struct Point *point, const double *a", NULL, RETURNS_VALUE, IN_ARGUMENT};
const struct FunctionText results_text = {"Computed variables of one thing",
                                          "results",
                                          "const struct Point *point, const double *a, double *value",
                                          "value",
                                          RETURNS_NOTHING,
                                          IN_ARGUMENT};
const struct FunctionText result_along_text = {
    "An output along a direction",
    "result_along",
    "const struct Point *point, const struct Seed *seed, const double *a, const double *da",
    NULL,
    RETURNS_VALUE,
    IN_ARGUMENT};
const struct FunctionText indicators_text = {"What changes its sign at events",
                                             "indicators",
                                             "const struct Point *point, const double *a, double *indicator",
                                             "indicator",
                                             RETURNS_NOTHING,
                                             IN_ARGUMENT};
const struct FunctionText switching_values_text = {"What decides on the modes",
                                                   "switching_values",
                                                   "const struct Point *point, const double *a, double *value",
                                                   "value",
                                                   RETURNS_NOTHING,
                                                   IN_ARGUMENT};
const struct FunctionText series_text = {
    "Taylor coefficients of the state up to the order",
    "series",
    "const struct Point *point, int order, const Series *restrict input, Series *restrict x, Series *restrict w",
    NULL,
    RETURNS_NOTHING,
    IN_WORKSPACE};
const struct FunctionText output_series_text = {
    "Taylor coefficients of the outputs up to the order",
    "output_series",
    "const struct Point *point, int order, const Series *restrict input, const Series *restrict x, Series *restrict w, "
    "Series *restrict y",
    NULL,
    RETURNS_NOTHING,
    IN_WORKSPACE};
const struct FunctionText limit_text = {
    "Shortens a step to where the series hide nothing",
    "limit",
    "const struct Point *point, const Series *restrict input, const Series *restrict x, const Series *restrict w, "
    "struct SeriesLimit *limit",
    NULL,
    RETURNS_NOTHING,
    IN_WORKSPACE};
const struct FunctionText watched_limit_text = {
    "Shortens a window of time to where what events look at hides nothing",
    "watched_limit",
    "const struct Point *point, const double *a, const Series *restrict input, const Series *restrict x, Series "
    "*restrict w, struct SeriesLimit *limit",
    NULL,
    RETURNS_NOTHING,
    IN_ARGUMENT};

void write_head(FILE *file, const struct FunctionText *text, const char *suffix, size_t operations) {
  static const char *const types[] = {[RETURNS_NOTHING] = "void", [RETURNS_STATUS] = "int", [RETURNS_VALUE] = "double"};
  fprintf(file, "/* %s; %zu operations */\nstatic %s %s%s(%s) {\n", text->comment, operations, types[text->returned],
          text->name, suffix, text->arguments);
}
