#include "robots/description/robot_options.h"

#include <string.h>

#include "base/memory.h"

/* The words in the order of enum RobotWord, each with its values; none for a name. */
static const struct {
  const char *name, *values[3];
} words[ROBOT_WORDS] = {
    [BASE_WORD] = {"base", {"fixed", "floating"}},
    [TOOL_WORD] = {"tool", {NULL}},
    [LIMITS_WORD] = {"limits", {"outputs", "stops"}},
    [FRICTION_WORD] = {"friction", {"creeps", "sticks"}},
    [EFFORT_WORD] = {"effort", {"unlimited", "limited"}},
    [GROUND_WORD] = {"ground", {NULL}},
    [KEYFRAME_WORD] = {"keyframe", {NULL}},
    [MOCAP_WORD] = {"mocap", {"still", "inputs"}},
    [SELF_WORD] = {"self", {"false", "true"}},
};

const char *robot_word(size_t index) {
  return words[index].name;
}

static bool says(const char *text, const char *value) {
  return text != NULL && strcmp(text, value) == 0;
}

struct RobotOptions robot_options_of(const char *const texts[ROBOT_WORDS]) {
  const char *ground = texts[GROUND_WORD];
  return (struct RobotOptions){.floats = says(texts[BASE_WORD], "floating"),
                               .has_stops = says(texts[LIMITS_WORD], "stops"),
                               .sticks = says(texts[FRICTION_WORD], "sticks"),
                               .is_effort_limited = says(texts[EFFORT_WORD], "limited"),
                               .has_ground = ground != NULL && strcmp(ground, "false") != 0,
                               .says_ground = ground != NULL,
                               .says_limits = texts[LIMITS_WORD] != NULL,
                               .says_friction = texts[FRICTION_WORD] != NULL,
                               .says_effort = texts[EFFORT_WORD] != NULL,
                               .ground_contact = ground != NULL && strcmp(ground, "true") != 0 ? ground : NULL,
                               .has_self = says(texts[SELF_WORD], "true"),
                               .inputs_move_mocap = says(texts[MOCAP_WORD], "inputs"),
                               .keyframe = texts[KEYFRAME_WORD],
                               .tool = texts[TOOL_WORD]};
}

/* Returns the word of "word=value"; ROBOT_WORDS for others. */
static size_t word_of(const char *text) {
  size_t word = 0, length = strcspn(text, "=");
  while (word < ROBOT_WORDS &&
         (strlen(words[word].name) != length || strncmp(text, words[word].name, length) != 0 || text[length] != '='))
    word++;
  return word;
}

bool robot_options_parse(const char *const *given, size_t count, struct RobotOptions *options,
                         struct Diagnostics *diagnostics) {
  const char *texts[ROBOT_WORDS] = {NULL};
  for (size_t i = 0; i < count; i++) {
    size_t word = word_of(given[i]);
    const char *value = word < ROBOT_WORDS ? given[i] + strlen(words[word].name) + 1 : "";
    const char *const *values = word < ROBOT_WORDS ? words[word].values : NULL;
    if (values != NULL && (values[0] == NULL || says(value, values[0]) || says(value, values[1]))) {
      texts[word] = value;
      continue;
    }
    report_error(diagnostics, 0, "'%s' is not an option for robots; expected %s", given[i],
                 values != NULL
                     ? format_text("%s=%s or %s=%s", words[word].name, values[0], words[word].name, values[1])
                     : "base, tool, limits, friction, effort, ground, keyframe, mocap or self, with = and a value");
    return false;
  }
  *options = robot_options_of(texts);
  return true;
}
