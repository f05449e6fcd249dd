"""Write files atomically. Also a module of the wheel."""

import os
import threading
from pathlib import Path

from .problem import Problem


def replace(temporary, path):
    """Sync a file to the disk and rename it, so that after a power failure the old or the new file exists completely."""
    with open(temporary, "rb+") as file:
        os.fsync(file.fileno())
    os.replace(temporary, path)


def write_whole(path, content):
    """Write a text or bytes, and return the path. On failure an existing file is unchanged, and the Problem names it."""
    path = Path(path)
    content = content.encode() if isinstance(content, str) else content
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.exists() and not path.is_file():  # a device, which cannot be replaced
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
        raise Problem(f"{path} cannot be written: {problem.strerror}; expected a writable folder with {len(content) / 1e6:.1g} MB of free space") from None
    return path
