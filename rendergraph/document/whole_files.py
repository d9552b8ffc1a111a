"""Files written whole or not at all: into a temporary neighbour first, renamed when complete."""

from __future__ import annotations

import errno
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rendergraph.document.messages import RenderGraphError, diagnose


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Yield a temporary path beside ``path``; move it into place on success, delete it on any exception.

    Raises RenderGraphError RG560 when the folder cannot be written or the disk is full.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=f".{path.stem}.", suffix=path.suffix, dir=path.parent)
        os.close(handle)
    except OSError as error:
        raise cannot_write(path, error) from None
    temporary = Path(name)
    try:
        yield temporary
        temporary.chmod(0o666 & ~_umask())
        temporary.replace(path)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        raise cannot_write(path, error) from None
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def require_folder(folder: Path) -> None:
    """Raise RenderGraphError RG560 where files could not be written into ``folder``, which need not exist yet.

    Nothing is made: this is asked before long work, so that it is not lost.
    """
    try:
        nearest = folder.absolute()
        while not nearest.exists():
            nearest = nearest.parent
        if not nearest.is_dir():
            raise FileExistsError(errno.EEXIST, "")
        if not os.access(nearest, os.W_OK | os.X_OK):
            raise PermissionError(errno.EACCES, "")
    except OSError as error:
        raise cannot_write(folder, error) from None


def require_file(path: Path) -> None:
    """Raise RenderGraphError RG560 where :func:`whole_file` could not write; see :func:`require_folder`."""
    require_folder(path.parent)
    if path.is_dir():
        raise cannot_write(path, IsADirectoryError(errno.EISDIR, ""))


def cannot_write(path: Path, error: OSError) -> RenderGraphError:
    """The diagnostic for a failed write."""
    return RenderGraphError([diagnose("RG560", path=str(path), reason=reason_of(error))], exit_code=2)


def reason_of(error: OSError) -> str:
    """Why writing failed, in a user's words."""
    reasons = {
        errno.ENOSPC: "the disk is full",
        errno.EFBIG: "the file would exceed the size limit",
        errno.EACCES: "no permission",
        errno.EROFS: "the file system is read-only",
        errno.ENOTDIR: "part of the path is a file, not a folder",
        errno.EISDIR: "a folder of that name is in the way",
        errno.EEXIST: "a file is in the way of the folder",
    }
    if error.errno is None:  # numpy's short writes come without one
        return f"the disk may be full ({error})"
    return reasons.get(error.errno, (error.strerror or str(error)).lower())


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
