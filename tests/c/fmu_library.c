#include "fmu_library.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void *find(void *handle, const char *name) {
  void *function = dlsym(handle, name);
  if (function != NULL) return function;
  fprintf(stderr, "the library has no function %s\n", name);
  exit(2);
}

struct FmuLibrary fmu_library_open(const char *path) {
  struct FmuLibrary library = {.handle = dlopen(path, RTLD_NOW | RTLD_LOCAL)};
  if (library.handle == NULL) {
    fprintf(stderr, "%s\n", dlerror());
    exit(2);
  }
  void *function;
#define FIND(name)                                                                                                     \
  function = find(library.handle, #name);                                                                              \
  memcpy(&library.name, &function, sizeof function);
  FMU_FUNCTIONS(FIND)
#undef FIND
  return library;
}

void fmu_library_close(struct FmuLibrary *library) {
  dlclose(library->handle);
}
