/*
 * <frame>, <point>, and bodies and particles in frames. A frame is its parent frame, translated and rotated step by
 * step. Components such as arm.x are named expressions. They wait for their frame or point, and that waits for its
 * parent frame.
 */
#pragma once

#include "read/context/attributes.h"

/* A point in a frame, or the centre of mass of a body, as functions of displacements. */
struct SpatialPoint {
  bool is_body;           /* of a body, whose name may also stand for its frame */
  size_t frame;           /* index into the model's frames */
  struct Vector offset;   /* m, along the frame's axes */
  struct Vector position; /* m, along the base's axes */
  struct Vector velocity; /* m/s, along the frame's axes */
};

/* Creates the base, the root of all frames; called before any element is read. */
void frames_begin(struct Reader *reader);

/* True for a <frame> or <point>, and for a body or particle in a frame. */
bool is_spatial(xmlNodePtr node);

/* Checks the steps of a <frame>, and declares the norm constraint of its quaternion. */
void declare_frame(struct Reader *reader, xmlNodePtr node);

/*
 * Collect the named expressions of an element. name: its full name. collect_frame() is for the frame of a planar body,
 * which rotates with it.
 */
void collect_frame(struct Reader *reader, xmlNodePtr node, const char *name);
void collect_spatial(struct Reader *reader, xmlNodePtr node, const char *name);

/* Reads a named expression of such an element: its pose if attribute is "", else a component. name: its name. */
struct Quantity read_spatial(struct Reader *reader, xmlNodePtr node, const char *name, const char *attribute);

/* Appends the components of an element to the model as variables. */
void append_element_variables(struct Reader *reader, xmlNodePtr node, const char *name);

/* Finds a point, a body or particle in a frame, or the origin of a frame by its name. Returns false for none. */
bool find_spatial_point(const struct Reader *reader, const char *name, struct SpatialPoint *point);

/* True if the current definition waits for the frame, point or body of this name, which has not been read. */
bool waits_for_element(struct Reader *reader, const char *name);

/* Returns the frame of this name, also of a planar body or of a body in a frame; NULL for none. */
const struct ReferenceFrame *find_frame(const struct Reader *reader, const char *name);

/*
 * Returns the frame that an attribute names, the base if the attribute is missing. NULL after reporting that there is
 * no such frame.
 */
const struct ReferenceFrame *frame_of_attribute(struct Reader *reader, xmlNodePtr node, const char *name);

/* Adds the regularizing inertia of a quaternion's norm, see struct Regularization; called when all bodies are known. */
void add_regularization_of_norm(struct Reader *reader, xmlNodePtr node);
