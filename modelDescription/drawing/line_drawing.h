/* Draws the lines of <line>. */
#ifndef LINE_DRAWING_H
#define LINE_DRAWING_H

#include "model/model.h"
#include "solids.h"

/*
 * Returns the values of the nodes of the lines' graph at the symbols' start values. The given values of the model's
 * nodes are on the constraints.
 */
double *values_of_lines(const struct Model *model, const double *values);

/* Sets the position of an end of a line, in m. */
void position_of_end(const struct LineEnd *end, const double *line_values, double position[3]);

/* Appends a line. size: of the picture, in m, by which hatches and coils are measured. */
void append_drawn_line(struct Drawing *drawing, const struct View *view, const struct DrawnLine *line,
                       const double *line_values, double size);

#endif
