#pragma once
// Files by descriptor: POSIX's open, read, write, close and stat, and functions for what each system does in
// its own way. They are in posix/system_files.h and windows/system_files.h; CMake chooses the folder.
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#include "system_files.h"
