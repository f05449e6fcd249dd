/* Conditions that have one outcome for all motions. */
#pragma once

#include "model/model.h"

enum Outcome { OUTCOME_VARIES, OUTCOME_NEVER, OUTCOME_ALWAYS };

/*
 * Returns the outcome of an event's condition, which is positive where it holds. OUTCOME_VARIES also if the outcome is
 * not found.
 */
enum Outcome outcome_of(const struct Model *model, Node condition);
