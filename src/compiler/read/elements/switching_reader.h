/* <mode>, <event>, <sample>, <stop>, <contact> and <friction>: the elements that make a system hybrid. */
#pragma once

#include "read/context/attributes.h"

/* Kinds of symbols in conditions and in forces that depend on modes. */
enum { IN_CONDITION = IN_FORCE & ~KIND(DISPLACEMENT) };

/* Returns a new mode named OF.WHAT that belongs to no variable. */
Node new_mode(struct Reader *reader, const char *of, const char *what);

/* Declare the modes and constraints of an element. */
void declare_mode(struct Reader *reader, xmlNodePtr node);
void declare_contact(struct Reader *reader, xmlNodePtr node);
void declare_stop(struct Reader *reader, xmlNodePtr node);
void declare_friction(struct Reader *reader, xmlNodePtr node);

/* Gives modes their indices, which follow those of the parameters; called after all declarations. */
void number_modes(struct Reader *reader);

/* Read the expressions of an element that was declared. */
void read_contact(struct Reader *reader, xmlNodePtr node);
void read_stop(struct Reader *reader, xmlNodePtr node);
void read_friction(struct Reader *reader, xmlNodePtr node);

/* Adds the constraint and the sliding force of a friction whose other fields are set. unit: of the forces. */
void complete_friction(struct Reader *reader, struct Friction *friction, struct Dimension unit);

void read_event(struct Reader *reader, xmlNodePtr node);
void read_sample(struct Reader *reader, xmlNodePtr node);

/*
 * Sets virtual displacements to zero in all switching functions, after all expressions. Reports functions that are zero
 * there identically.
 */
void undisplace_branches(struct Reader *reader);

/* Adds the forces of frictions in planes, once those with prescribed velocities are known. */
void add_sliding_forces_in_planes(struct Reader *reader);

/* Replaces NAME.force of frictions, after all expressions, by the sliding force while they slide. */
void complete_friction_forces(struct Reader *reader);
