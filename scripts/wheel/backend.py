"""scikit-build-core, which is told that the wheel runs on more machines than the one it is built on: see CMakeLists.txt."""

import os
import platform

from scikit_build_core.build import *  # noqa: F403

os.environ["_PYTHON_HOST_PLATFORM"] = f"manylinux_2_17-{platform.machine()}"
