#include "base/platform.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#ifdef _WIN32

#include <ctype.h>
#include <direct.h>
#include <fcntl.h>
#include <io.h>

/* A temporary file, since Windows has no memory streams. It is kept in memory if possible, and deleted when closed. */
FILE *open_text_stream(char **text, size_t *length) {
  *text = NULL;
  *length = 0;
  char *path = _tempnam(NULL, "lagc");
  FILE *file = path != NULL ? fopen(path, "w+bTD") : NULL;
  free(path);
  return file;
}

bool close_text_stream(FILE *file, char **text, size_t *length) {
  long end = ftell(file);
  rewind(file);
  *length = end > 0 ? (size_t)end : 0;
  *text = calloc(*length + 1, 1);
  bool read = *text != NULL && fread(*text, 1, *length, file) == *length;
  fclose(file);
  return read;
}

static int create(const char *path) {
  return _mkdir(path);
}

char *resolve_path(const char *path) {
  return _access(path, 0) == 0 ? _fullpath(NULL, path, 0) : NULL;
}

char *first_separator(char *path) {
  return strpbrk(path, "/\\");
}

const char *last_separator(const char *path) {
  const char *slash = strrchr(path, '/'), *backslash = strrchr(path, '\\');
  return slash == NULL || (backslash != NULL && backslash > slash) ? backslash : slash;
}

bool is_absolute(const char *path) {
  return *path == '/' || *path == '\\' || (isalpha((unsigned char)*path) && path[1] == ':');
}

void limit_memory(size_t bytes) {
  (void)bytes;
}

void write_plain_lines(void) {
  _setmode(_fileno(stdout), _O_BINARY);
}

#else

#ifndef __wasi__
#include <sys/resource.h>
#endif

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
enum { HAS_SANITIZER = 1 };
#elif defined(__has_feature)
enum {
  HAS_SANITIZER = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
};
#else
enum { HAS_SANITIZER = 0 };
#endif

FILE *open_text_stream(char **text, size_t *length) {
  return open_memstream(text, length);
}

bool close_text_stream(FILE *file, char **text, size_t *length) {
  (void)length;
  return fclose(file) == 0 && *text != NULL;
}

static int create(const char *path) {
  return mkdir(path, 0777);
}

char *resolve_path(const char *path) {
  return realpath(path, NULL);
}

char *first_separator(char *path) {
  return strchr(path, '/');
}

const char *last_separator(const char *path) {
  return strrchr(path, '/');
}

bool is_absolute(const char *path) {
  return *path == '/';
}

#ifdef __wasi__
/* A WebAssembly module has its own limit. */
void limit_memory(size_t bytes) {
  (void)bytes;
}
#else
void limit_memory(size_t bytes) {
  struct rlimit limit;
  if (HAS_SANITIZER || getrlimit(RLIMIT_AS, &limit) != 0) return;
  if (limit.rlim_cur > bytes) limit.rlim_cur = bytes;
  setrlimit(RLIMIT_AS, &limit);
}
#endif

void write_plain_lines(void) {
}

#endif

bool make_directory(const char *path) {
  struct stat status;
  return create(path) == 0 || (stat(path, &status) == 0 && S_ISDIR(status.st_mode));
}
