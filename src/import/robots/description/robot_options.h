/* Options of an <include>, or of the command line, for robots. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include <libxml/tree.h>

#include "base/diagnostics.h"

/* The options; zeros for none. */
struct RobotOptions {
  bool floats;     /* the root link moves freely; else it is fixed in the base */
  bool has_stops;  /* limits are stops; else outputs report violations */
  bool sticks;     /* joint friction is dry; else it is regularized and allows creep */
  bool has_ground; /* shapes of links touch a plane */
  bool has_self;   /* shapes of links touch each other and static ones */
  bool says_ground, says_limits, says_friction, says_effort; /* has these attributes, with any value */
  const char *ground_contact; /* names of these links, separated by blanks; NULL for all that move */
  bool inputs_move_mocap;     /* bodies with mocap follow inputs; else they stand still */
  bool is_effort_limited;     /* motors are limited by their effort */
  const char *keyframe;       /* name of the MJCF keyframe for start values; NULL for the default */
  const char *tool;           /* link with outputs of its position and velocity; NULL for the only leaf */
  xmlNodePtr include;         /* NULL on the command line */
  /* NULL on the command line. own_start: returns the start that an <include> gives a coordinate; NULL for none. */
  char *(*own_start)(const void *context, const char *coordinate);
  const void *context;
  bool (*value_of)(const char *text, double *value); /* of an expression of numbers; false for others */
};

/* The attributes of an <include> for these options. */
enum RobotWord {
  BASE_WORD,
  TOOL_WORD,
  LIMITS_WORD,
  FRICTION_WORD,
  EFFORT_WORD,
  GROUND_WORD,
  KEYFRAME_WORD,
  MOCAP_WORD,
  SELF_WORD,
  ROBOT_WORDS
};

/* Returns the name of such an attribute. */
const char *robot_word(size_t index);

/* Returns the options for the values of these attributes, NULL for missing ones. */
struct RobotOptions robot_options_of(const char *const texts[ROBOT_WORDS]);

/* Sets the options from texts such as "base=floating". Returns false after reporting a wrong one. */
bool robot_options_parse(const char *const *given, size_t count, struct RobotOptions *options,
                         struct Diagnostics *diagnostics);
