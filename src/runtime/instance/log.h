/* Statuses of calls, and messages to the importer. */
#pragma once

#include <stdbool.h>

/* Makes compilers check the arguments of a format. */
#ifdef __GNUC__
#define LIKE_PRINTF(slot, first) __attribute__((format(printf, slot, first)))
#else
#define LIKE_PRINTF(slot, first)
#endif

struct Instance;

/* Ordered from best to worst. */
enum Status {
  STATUS_DONE,
  STATUS_WARNING,
  STATUS_DISCARD, /* not possible here; the instance can be read, and continue from an earlier state */
  STATUS_ERROR    /* the instance can only be reset */
};

/* Bytes of a message, with the terminating zero; longer ones are cut off. */
enum { MESSAGE_LENGTH = 600 };

/* Receiver of messages. */
struct Log {
  void (*write)(void *receiver, enum Status status, const char *message);
  void *receiver;
  unsigned wanted; /* bits 1 << status; other messages are not formatted */
};

/* Keeps the first message, as a receiver of at least MESSAGE_LENGTH bytes that begin with a zero. */
void log_keep_first(void *receiver, enum Status status, const char *message);

/* A log whose messages of STATUS_DISCARD are deferred. */
struct DeferredLog {
  struct Log log;
  char text[MESSAGE_LENGTH]; /* the first such message; empty for none */
};

/* Defers messages of STATUS_DISCARD until log_release(); log_write_deferred() writes the first one, if there is any. */
void log_defer(struct Instance *instance, struct DeferredLog *deferred);
void log_release(struct Instance *instance, const struct DeferredLog *deferred);
void log_write_deferred(const struct Instance *instance, const struct DeferredLog *deferred);

/* Formats a message and writes it to the receiver, if its status is wanted. */
void log_write(const struct Log *log, enum Status status, const char *format, ...) LIKE_PRINTF(3, 4);

/* Writes a message to the log of the instance. */
void log_message(const struct Instance *instance, enum Status status, const char *format, ...) LIKE_PRINTF(3, 4);

/* Logs an error and puts the instance into PHASE_ERROR until it is reset. Returns STATUS_ERROR. */
enum Status log_error(struct Instance *instance, const char *format, ...) LIKE_PRINTF(2, 3);

/* Logs that a call is not allowed, with the name of its function before the message, as log_error() does. */
enum Status reject_call(struct Instance *instance, const char *format, ...) LIKE_PRINTF(2, 3);

/* Logs why a call has no effect, with the name of its function before the message. Returns STATUS_DISCARD. */
enum Status discard_call(const struct Instance *instance, const char *format, ...) LIKE_PRINTF(2, 3);
