#include "write/function_text.h"

#include <string.h>

const struct FunctionText start_text = {"d state / dt, and the first coefficients of all series",
                                        "start",
                                        "const struct Point *point, double *derivative, Series *restrict w",
                                        "derivative",
                                        RETURNS_STATUS,
                                        IN_TARGET};
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

bool takes(const struct FunctionText *text, const char *argument) {
  return strstr(text->arguments, argument) != NULL;
}

void write_head(FILE *file, const struct FunctionText *text, const char *suffix, size_t operations) {
  static const char *const types[] = {[RETURNS_NOTHING] = "void", [RETURNS_STATUS] = "int", [RETURNS_VALUE] = "double"};
  fprintf(file, "/* %s; %zu operations */\nstatic %s %s%s(%s) {\n", text->comment, operations, types[text->returned],
          text->name, suffix, text->arguments);
}
