"""Writing files so that nobody ever finds half of one."""

from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path


def atomic_write(path: str | Path, content: str | bytes) -> None:
    """Write ``content`` to ``path`` completely or not at all.

    The content goes to a temporary file in the same directory, is forced to the disk and renamed over
    ``path``, which is atomic: a reader finds the old file or the new one. On any failure, an interrupt from
    the keyboard included, the temporary file is removed and ``path`` is as it was.

    Args:
        path: Where to; its directory must exist. A symbolic link is written through, not replaced.
        content: Text is written as UTF-8, its line ends unchanged.

    Raises:
        OSError: The directory is missing or not writable, or the disk is full.
    """
    target = Path(path).resolve()
    data = content.encode() if isinstance(content, str) else content
    descriptor, temporary = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.", suffix=".part")
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(temporary, _mode(target))
        os.replace(temporary, target)
    except BaseException:
        with contextlib.suppress(FileNotFoundError):
            os.unlink(temporary)
        raise


def _mode(target: Path) -> int:
    """Permissions of the file that is replaced, or those that a newly created file would get."""
    try:
        return target.stat().st_mode & 0o777
    except FileNotFoundError:
        mask = os.umask(0)
        os.umask(mask)
        return 0o666 & ~mask
