/*
 * Forms of instructions: two have the same form if they differ in numbers and parameters alone, as do those of two
 * points of a shape. In a table they follow each other, so that their operands are equally spaced.
 */
#pragma once

#include "program/codegen/ir.h"

/* The forms of the values that a function's instructions compute, as hashes; equal forms have equal hashes. */
struct Forms {
  uint32_t *of_local, *of_row;
};

/* Returns the forms in a function. forms_release() frees them. */
struct Forms forms_create(const struct IrFunction *ir);
void forms_release(struct Forms *forms);

/* Returns the form of an instruction. */
uint32_t form_of(const struct Forms *forms, const struct Instruction *instruction);
