/*
 * The cost model: arithmetic operations of the generated functions. From them the runtime chooses between methods and
 * limits the work of a communication step.
 */
#pragma once

#include "program/program.h"

/* Returns the operations of each part of a step, for a method that integrates by Taylor series. */
struct OperationCounts operation_counts_of(const struct Program *program);

/* Returns the work of an evaluation, a step and an event, for a system with coordinates. */
struct StepWork step_work_of(const struct Program *program);
