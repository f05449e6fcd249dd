"""Files that are there as a whole or not at all. Also a module of the wheel."""

import os
import threading
from pathlib import Path

from .problem import Problem


def replace(temporary, path):
    """Gives a file its name when it is on the disk, so that a machine that loses power leaves it whole or not at all."""
    with open(temporary, "rb+") as file:
        os.fsync(file.fileno())
    os.replace(temporary, path)


def write_whole(path, content):
    """Writes a text or bytes, and returns the path. A file that was there stays as it was if that fails, and the Problem names it."""
    path = Path(path)
    content = content.encode() if isinstance(content, str) else content
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.exists() and not path.is_file():  # a device
            path.write_bytes(content)
            return path
        target = path.resolve()
        temporary = target.with_name(f".{target.name}.{os.getpid()}-{threading.get_ident()}")
        try:
            temporary.write_bytes(content)
            replace(temporary, target)
        finally:
            temporary.unlink(missing_ok=True)
    except OSError as problem:
        raise Problem(f"{path} cannot be written: {problem.strerror}; expected a folder that can be written, with {len(content) / 1e6:.1g} MB of room") from None
    return path
