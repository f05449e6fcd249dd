/*
 * Switches a system: finds where a mode may change, and the modes, velocities and states behind an event. FMUs that do not
 * switch do not hold it.
 */
#ifndef EVENT_LAWS_H
#define EVENT_LAWS_H

#include "instance/instance.h"

/* Why the modes are looked at. */
enum Occasion {
  AT_START,   /* of the simulation: no mode is known yet */
  AT_CHANGE,  /* a parameter, an input or a state may have been set */
  AT_EVENT,   /* an indicator has just changed its sign */
  IN_EXCHANGE /* the importer asks, who may have gone past the zero of an indicator */
};

struct CommunicationStep;

/* How far a communication step has come with its events. */
struct EventProgress {
  double searched;  /* no event before this time is left */
  bool is_lost;     /* behind what was searched there is an event that cannot be told */
  int gathered;     /* how many have come within the rounding of time, or of what they wait for */
  int crowded;      /* how many of one indicator have come close together, without leaving 0 by more than rounding */
  double last;      /* event, from the start of the step on; 0 for none */
  double distance;  /* between the last two; 0 for none */
  long count;       /* of all in the step */
  int unsure;       /* windows in the step in which something may hide */
  double reach;     /* in s: how far the solver may go at once, since events lie too close for more; 0 for any */
  int nearer;       /* how often that was shortened since a step without events */
  size_t indicator; /* whose zero the last one was */
  bool has_lifted;  /* it was a contact that opened as its force went */
};

struct EventLaws {
  /* Numbers of workspace that an instance needs. */
  size_t (*work_count)(void);
  /*
   * Brings the modes into agreement with the state that an importer has integrated to, with impacts and events, which change
   * the state. changed tells whether anything did. NULL, or the reason why the motion cannot go on, after logging what is to
   * blame.
   */
  const char *(*settle)(struct Instance *instance, bool *changed);
  /* Sets the modes to what start values say, as long as these may be set: no contact is closed, and all friction slides. */
  void (*guess)(struct Instance *instance);
  /* The modes of the start values, after impacts and events at the start itself; false after logging an error. */
  bool (*start)(struct Instance *instance);
  /*
   * Opens contacts that a parameter, an input or a state has moved apart, and lets frictions slide that it has set in motion;
   * false after logging why the step is discarded, as bodies that stand in one another.
   */
  bool (*part)(struct Instance *instance, double time);
  /* The modes after a parameter, an input or a state was set; false after logging why the step is discarded. */
  bool (*settle_change)(struct Instance *instance, double time);
  /*
   * The modes and the state behind the event that ended a step, or after a parameter, an input or a state was set; changed
   * tells whether anything was. NULL, or the reason why the motion cannot go on.
   */
  const char *(*update)(struct Instance *instance, bool *changed);
  /* Goes through the next event of the solver's last step. NULL, or the reason why the motion ends there. */
  const char *(*pass)(struct Instance *instance, struct CommunicationStep *step, struct EventProgress *progress);
  /* What must hold where a communication step ends. NULL, or the reason why it does not, after logging what is to blame. */
  const char *(*check)(struct Instance *instance, double time);
  /* Where the solver cannot go on: a zero that it cannot reach may be next to it. The problem, or NULL. */
  const char *(*pass_barrier)(struct Instance *instance, struct CommunicationStep *step, const char *problem,
                              struct EventProgress *progress);
  /* Logs what switched in a step that has too many solver's steps, where most of them ended at events. */
  void (*explain)(struct Instance *instance, const struct CommunicationStep *step,
                  const struct EventProgress *progress);
  /* Logs why the solver stopped at the instance's state, where a contact has jammed; false where none has. */
  bool (*explain_stop)(struct Instance *instance, double time);
  /* Whether the constraint is that of a contact or a friction, whose events tell by themselves where they end. */
  bool (*holds_at_times)(const char *constraint);
  /*
   * Moves a point at which an importer tries a piece beyond its end to that end, by the velocities there; its state is then in
   * workspace. False where there is none, or where it does not help.
   */
  bool (*come_back)(struct Instance *instance, struct Point *point);
  /* The indicators at the situation as an importer is told them; false where there are no accelerations. */
  bool (*indicators)(struct Instance *instance, double *value);
  /* Whether an indicator has a sign at the situation that its mode does not allow. */
  bool (*is_due)(struct Instance *instance);
};

extern const struct EventLaws event_laws;

#endif
