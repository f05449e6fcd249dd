/* Paths of files that name each other. */
#pragma once

/* The one absolute path of a file; NULL where there is no such file, and errno tells why. */
char *canonical_path(const char *path);

/* The name of a file without its folder; a part of the path. */
const char *file_name(const char *path);

/* A path that a file names, relative to that file. */
char *path_beside_file(const char *present, const char *named);
