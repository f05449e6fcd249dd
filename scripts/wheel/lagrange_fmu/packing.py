"""Pack an FMU reproducibly: equal content gives equal bytes."""

import io
import zipfile

from .whole_files import write_whole

TIME = (2000, 1, 1, 0, 0, 0)  # modification time of all members, so that archives are reproducible


def pack(content, archive):
    """Write all files of the folder `content` into the zip archive, modelDescription.xml first, the others in order of name."""
    members = sorted(path.relative_to(content).as_posix() for path in content.rglob("*") if path.is_file())
    members.sort(key=lambda member: member != "modelDescription.xml")
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as file:
        for member in members:
            entry = zipfile.ZipInfo(member, TIME)
            entry.create_system = 3  # Unix, so that external_attr holds permissions
            entry.external_attr = 0o100644 << 16
            file.writestr(entry, (content / member).read_bytes(), zipfile.ZIP_DEFLATED, 9)
    write_whole(archive, packed.getvalue())
