/* <mode>, <event>, <sample>, <stop>, <contact> and <friction>: what switches a system. */
#pragma once

#include "read/context/attributes.h"

/* What may stand in conditions, and in forces that switch. */
enum { IN_CONDITION = IN_FORCE & ~KIND(DISPLACEMENT) };

/* A mode of no variable, named by what it is of. */
Node new_mode(struct Reader *reader, const char *of, const char *what);

/* Make the modes and the constraints of an element known. */
void declare_mode(struct Reader *reader, xmlNodePtr node);
void declare_contact(struct Reader *reader, xmlNodePtr node);
void declare_stop(struct Reader *reader, xmlNodePtr node);
void declare_friction(struct Reader *reader, xmlNodePtr node);

/* After all declarations: modes count on behind the parameters. */
void number_modes(struct Reader *reader);

/* Read their expressions, in the order of their declarations. */
void read_contact(struct Reader *reader, xmlNodePtr node);
void read_stop(struct Reader *reader, xmlNodePtr node);
void read_friction(struct Reader *reader, xmlNodePtr node);

/* Lets a friction act whose velocities are set, and its force and stiction; unit: of these. */
void complete_friction(struct Reader *reader, struct Friction *friction, struct Dimension unit);

void read_event(struct Reader *reader, xmlNodePtr node);
void read_sample(struct Reader *reader, xmlNodePtr node);

/* After all expressions: what decides on branches has the displacements at 0; reports what turns just there. */
void undisplace_branches(struct Reader *reader);

/* After all expressions: NAME.force of a friction, in events and outputs, is that while it slides too. */
void complete_friction_forces(struct Reader *reader);
