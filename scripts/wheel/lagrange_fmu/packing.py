"""The archive of an FMU: the same content gives the same bytes."""

import io
import zipfile

from .whole_files import write_whole

TIME = (2000, 1, 1, 0, 0, 0)  # of all files


def pack(content, archive):
    """All of a folder, modelDescription.xml first."""
    members = sorted(path.relative_to(content).as_posix() for path in content.rglob("*") if path.is_file())
    members.sort(key=lambda member: member != "modelDescription.xml")
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as file:
        for member in members:
            entry = zipfile.ZipInfo(member, TIME)
            entry.create_system = 3  # Unix, whose permissions these are
            entry.external_attr = 0o100644 << 16
            file.writestr(entry, (content / member).read_bytes(), zipfile.ZIP_DEFLATED, 9)
    write_whole(archive, packed.getvalue())
