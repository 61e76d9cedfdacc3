"""One run at a time in a folder: an advisory lock, held for the life of a run."""

from __future__ import annotations

import errno
import fcntl
import json
import os
import socket
import stat
import warnings
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from ..errors import UserError
from ..util.files import clear_errors
from .folder import RunFolder

# What systems answer where a file system has no locks.
NO_LOCKS = {errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP, errno.EINVAL}
# For writing, without which NFS gives no exclusive lock; not through a link, and without waiting.
FLAGS = os.O_RDWR | os.O_NOFOLLOW | os.O_NONBLOCK
LONGEST = 500  # bytes of what is read of a lock


@dataclass(frozen=True)
class Holder:
    """Who holds a lock; `pid` is 0 where that is not known."""

    pid: int = 0
    host: str = ""

    @classmethod
    def of(cls, descriptor: int) -> Holder:
        """Who has written into a lock."""
        try:
            said = json.loads(os.pread(descriptor, LONGEST, 0))
            return cls(int(said["pid"]), str(said["host"]))
        except (ValueError, KeyError, TypeError):
            return cls()

    def __str__(self) -> str:
        return f"process {self.pid} on {self.host}" if self.pid else "another process"


class FolderLock:
    """The right to write into the folder of a run, which one process has at a time.

    The system takes it back when the process ends, however it ends. While the folder is not there
    yet, what is locked is the one in which it is prepared (see RunFolder.prepared).
    """

    def __init__(self, directory: str | Path) -> None:
        self._folder = RunFolder(Path(directory).resolve())
        self._descriptor: int | None = None
        self._made: list[Path] = []  # folders

    def take(self) -> None:
        """Take the lock; raises UserError naming the holder where another process has it."""
        with clear_errors(self._folder.path):
            while self._descriptor is None:
                place = self._place()
                self._make(place.path)
                self._take_in(place)

    def release(self) -> None:
        """Give it back, and leave nothing where no run has begun."""
        if self._descriptor is None:
            return
        for place in (self._folder, self._folder.prepared):
            if _is_open_at(self._descriptor, place.lock):
                with suppress(OSError):
                    place.lock.unlink()
        os.close(self._descriptor)
        self._descriptor = None
        if self._folder.prepared.path.is_dir():
            self._folder.prepared.remove()
        for folder in reversed(self._made):
            with suppress(OSError):  # something is in it: a run
                folder.rmdir()

    def _place(self) -> RunFolder:
        """The folder, or the one in which it will be prepared."""
        return self._folder if self._folder.path.exists() else self._folder.prepared

    def _make(self, folder: Path) -> None:
        """Make a folder, and remember what was made."""
        missing = [path for path in (folder, *folder.parents) if not path.exists()]
        for path in reversed(missing):
            path.mkdir(exist_ok=True)
            self._made.append(path)

    def _take_in(self, place: RunFolder) -> None:
        """Try to lock; nothing is held afterwards if the folder has changed in between."""
        descriptor = os.open(place.lock, FLAGS | os.O_CREAT, 0o666)
        try:
            if not stat.S_ISREG(os.fstat(descriptor).st_mode):
                raise UserError(f"{place.lock}: not a regular file")
            _lock(descriptor, self._folder.path)
            # Whoever had it may have removed the file, or given the folder its name.
            if not _is_open_at(descriptor, place.lock) or self._place().path != place.path:
                os.close(descriptor)
                return
            said = {"pid": os.getpid(), "host": socket.gethostname()}
            os.ftruncate(descriptor, 0)
            os.pwrite(descriptor, json.dumps(said).encode(), 0)
            os.fsync(descriptor)
        except BaseException:
            os.close(descriptor)
            raise
        self._descriptor = descriptor


def holder_of(directory: Path) -> Holder | None:
    """Who writes into a folder now; None if nobody does."""
    try:
        descriptor = os.open(RunFolder(directory).lock, FLAGS)
    except OSError:
        return None
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return None if error.errno in NO_LOCKS else Holder.of(descriptor)
    finally:
        os.close(descriptor)
    return None


def _lock(descriptor: int, folder: Path) -> None:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        if error.errno in NO_LOCKS:
            warnings.warn(
                f"{folder}: this file system has no locks; see to it that one run at a time writes"
                " here",
                RuntimeWarning,
                stacklevel=2,
            )
            return
        raise in_use(folder, Holder.of(descriptor)) from None


def in_use(folder: Path, holder: Holder) -> UserError:
    """What to say of a folder that another process holds."""
    return UserError(
        f"{folder}: {holder} is writing here; wait for it, stop it with the file {folder}/STOP, or"
        " choose another folder"
    )


def _is_open_at(descriptor: int, path: Path) -> bool:
    """Whether the file that is open is still the one at `path`."""
    try:
        return os.path.samestat(os.fstat(descriptor), path.stat(follow_symlinks=False))
    except OSError:
        return False
