/*
 * <frame>, <point>, and bodies and particles that are placed in frames. Their components, such as arm.x, are named
 * expressions; each waits for what it is part of, and that for the frame that it is in.
 */
#pragma once

#include "read/context/attributes.h"

/* A point, or the centre of mass of a body, in a frame; all of it as functions of displacements too. */
struct SpatialPoint {
  bool is_body;           /* which turns, so that it may stand for its frame */
  size_t frame;           /* among the model's */
  struct Vector offset;   /* along the frame's axes */
  struct Vector position; /* along the base's */
  struct Vector velocity; /* along the frame's */
};

/* The base, in which all frames are; before anything is read. */
void frames_begin(struct Reader *reader);

/* Whether the element is a <frame> or <point>, or a body or particle in a frame. */
bool is_spatial(xmlNodePtr node);

/* Checks the steps of a <frame>, and declares the constraint of its quaternion. */
void declare_frame(struct Reader *reader, xmlNodePtr node);

/* Adds what the element names to the definitions; name: its own. A planar body gives a frame that turns with it. */
void collect_frame(struct Reader *reader, xmlNodePtr node, const char *name);
void collect_spatial(struct Reader *reader, xmlNodePtr node, const char *name);

/*
 * Reads a named expression of such an element: the whole of it where attribute is "", else one component. name: that of
 * the expression.
 */
struct Quantity read_spatial(struct Reader *reader, xmlNodePtr node, const char *name, const char *attribute);

/* Enters the components of an element into the model's places. */
void append_places(struct Reader *reader, xmlNodePtr node, const char *name);

/* What was read under the name: a point, body or particle in a frame, or the origin of a frame; false for none. */
bool find_spatial_point(const struct Reader *reader, const char *name, struct SpatialPoint *point);

/* Whether the present definition waits for the frame, point or body in a frame of this name, which is not read yet. */
bool waits_for_place(struct Reader *reader, const char *name);

/* The frame of this name, also that of a planar body, or of one that is placed in a frame; NULL where there is none. */
const struct ReferenceFrame *find_frame(const struct Reader *reader, const char *name);

/*
 * The frame that an attribute names, along whose axes something is given; the base where it names none, NULL after
 * reporting that there is none.
 */
const struct ReferenceFrame *frame_of_attribute(struct Reader *reader, xmlNodePtr node, const char *name);

/* Of a <frame> with a quaternion, when all bodies are known: the inertia of its norm, see model.h. */
void add_stillness_of_norm(struct Reader *reader, xmlNodePtr node);
