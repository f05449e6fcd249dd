/* Rotation of matrices. */
#pragma once

#include "model/kinematics.h"

/* Returns R matrix R^T for a rotation R. */
struct Matrix matrix_rotated(struct Graph *graph, const struct Matrix *rotation, const struct Matrix *matrix);
