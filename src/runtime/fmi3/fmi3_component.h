/* An instance of FMI 3.0: the core, and the caller's callbacks. */
#pragma once

#include "fmi3.h"
#include "stepping/intermediate.h"

/* Uses of workspace for converted arguments. */
enum WorkspaceUse { WORKSPACE_REFERENCES, WORKSPACE_KNOWNS, WORKSPACE_VALUES, WORKSPACE_COUNT };

/* A block that grows on demand; size in bytes. */
struct Workspace {
  void *block;
  size_t size;
};

/* An fmi3Instance points to this; the instance is its first member. */
struct FmiComponent {
  struct Instance instance;
  fmi3LogMessageCallback logger;
  fmi3InstanceEnvironment environment;
  unsigned categories;                                /* bits of the enabled log categories */
  fmi3IntermediateUpdateCallback intermediate_update; /* NULL for none */
  struct Intermediate intermediate;
  bool sets_inputs; /* some of requiredIntermediateVariables are inputs */
  bool early_return_allowed;
  bool has_returned_early; /* the callback asked for the end of the step */
  void *before;            /* the snapshot before a communication step */
  struct Workspace workspaces[WORKSPACE_COUNT];
};

/* Returns the receiver of the component's messages. */
struct Log log_of(struct FmiComponent *component);

/* Returns the status for the caller. */
static inline fmi3Status status_of(enum Status status) {
  static const fmi3Status of[] = {[STATUS_DONE] = fmi3OK,
                                  [STATUS_WARNING] = fmi3Warning,
                                  [STATUS_DISCARD] = fmi3Discard,
                                  [STATUS_ERROR] = fmi3Error};
  return of[status];
}
