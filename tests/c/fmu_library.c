#include "fmu_library.h"

#ifdef _WIN32
#include <windows.h>
#else
#include <dlfcn.h>
#endif
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
typedef FARPROC Function;

static void *open_library(const char *path) {
  void *handle = LoadLibraryA(path);
  if (handle == NULL) fprintf(stderr, "%s: error %lu\n", path, GetLastError());
  return handle;
}

static Function function_named(void *handle, const char *name) {
  return GetProcAddress(handle, name);
}

static void close_library(void *handle) {
  FreeLibrary(handle);
}
#else
typedef void *Function;

static void *open_library(const char *path) {
  void *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (handle == NULL) fprintf(stderr, "%s\n", dlerror());
  return handle;
}

static Function function_named(void *handle, const char *name) {
  return dlsym(handle, name);
}

static void close_library(void *handle) {
  dlclose(handle);
}
#endif

static Function find(void *handle, const char *name) {
  Function function = function_named(handle, name);
  if (function != NULL) return function;
  fprintf(stderr, "the library has no function %s\n", name);
  exit(2);
}

struct FmuLibrary fmu_library_open(const char *path) {
  struct FmuLibrary library = {.handle = open_library(path)};
  if (library.handle == NULL) exit(2);
  Function function;
#define FIND(name)                                                                                                     \
  function = find(library.handle, #name);                                                                              \
  memcpy(&library.name, &function, sizeof function);
  FMU_FUNCTIONS(FIND)
#undef FIND
  return library;
}

void fmu_library_close(struct FmuLibrary *library) {
  close_library(library->handle);
}
