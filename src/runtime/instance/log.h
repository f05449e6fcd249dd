/* How requests end, and messages about it, which an interface hands on to its caller. */
#ifndef LOG_H
#define LOG_H

/* Lets compilers that know it check the arguments of a format. */
#ifdef __GNUC__
#define LIKE_PRINTF(place, first) __attribute__((format(printf, place, first)))
#else
#define LIKE_PRINTF(place, first)
#endif

struct Instance;

/* From best to worst. */
enum Status {
  STATUS_DONE,
  STATUS_WARNING,
  STATUS_DISCARD, /* not possible here, but the instance can be read, or go on from an earlier state */
  STATUS_ERROR    /* the instance goes on after a reset alone */
};

enum { MESSAGE_LENGTH = 600 };

/* Where messages go. */
struct Log {
  void (*write)(void *receiver, enum Status status, const char *message);
  void *receiver;
  unsigned wanted; /* bits 1 << status; other messages are not even formatted */
};

void log_write(const struct Log *log, enum Status status, const char *format, ...) LIKE_PRINTF(3, 4);

void log_message(const struct Instance *instance, enum Status status, const char *format, ...) LIKE_PRINTF(3, 4);

/* Logs an error and makes the instance refuse to go on until it is reset; returns STATUS_ERROR. */
enum Status log_error(struct Instance *instance, const char *format, ...) LIKE_PRINTF(2, 3);

/* The same of a call that cannot be; the name of the function that was called comes before the message. */
enum Status refuse_call(struct Instance *instance, const char *format, ...) LIKE_PRINTF(2, 3);

/* Logs why a call has no effect, with the name of its function before the message; returns STATUS_DISCARD. */
enum Status discard_call(const struct Instance *instance, const char *format, ...) LIKE_PRINTF(2, 3);

#endif
