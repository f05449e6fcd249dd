/* Matrices along other axes. */
#pragma once

#include "model/kinematics.h"

/* R matrix R^T for a rotation R. */
struct Matrix matrix_turned(struct Graph *graph, const struct Matrix *rotation, const struct Matrix *matrix);
