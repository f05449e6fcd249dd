/* Where the meshes of a robot are. */
#pragma once

/*
 * The path, relative to the robot's file, of what that file names: a path of this kind, file:///PATH, or package://NAME/PATH, which is NAME/PATH
 * or PATH in the robot's folder or else the nearest one above it. NULL where there is no such file.
 */
char *path_in_package(const char *robot, const char *named);
