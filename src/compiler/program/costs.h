/* What the generated functions cost, by which the runtime chooses between methods and bounds the work of a step. */
#pragma once

#include "program/program.h"

/* For a method that hands over, which has series and a Jacobian. */
struct OperationCounts operation_counts_of(const struct Program *program);

/* For a system with coordinates. */
struct StepWork step_work_of(const struct Program *program);
