"""Safe input: regular files only, up to a size limit."""

from __future__ import annotations

import errno
import os
import stat
import sys
from os import PathLike
from typing import BinaryIO


def open_regular(path: str | PathLike[str]) -> BinaryIO:
    """Open a regular file for reading bytes.

    A device may have no end, and a named pipe may wait for ever for somebody who writes into it.

    Raises
    ------
    OSError
        If there is no such file, it may not be read, or is no regular one.
    """
    # A named pipe that nobody writes into would block here already.
    flags = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)  # not on every system
    descriptor = os.open(path, os.O_RDONLY | flags)
    try:
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            reason = "a directory, device or pipe, and no regular file"
            raise OSError(errno.EINVAL, reason, os.fspath(path))
        return os.fdopen(descriptor, "rb")
    except BaseException:
        os.close(descriptor)
        raise


def read_text(path: str | PathLike[str], most: int, encoding: str = "utf-8") -> str:
    """Return the text of a regular file, or of what another program pipes in.

    Parameters
    ----------
    path : path-like
        The file.
    most : int
        Bytes that it may have.
    encoding : str
        How its characters are encoded.

    Raises
    ------
    OSError
        As by `open_regular`, or if the file is larger.
    UnicodeDecodeError
        If its bytes are no such text.
    """
    piped = os.fspath(path).startswith(("/dev/stdin", "/dev/fd/", "/proc/self/fd/"))
    with open(path, "rb") if piped else open_regular(path) as file:
        return _read(file, most, encoding, os.fspath(path))


def read_piped(most: int, encoding: str = "utf-8") -> str:
    """Return the text of the standard input.

    Parameters
    ----------
    most, encoding
        As of `read_text`.

    Raises
    ------
    OSError
        If it is larger.
    UnicodeDecodeError
        If its bytes are no such text.
    """
    return _read(sys.stdin.buffer, most, encoding, "standard input")


def _read(file: BinaryIO, most: int, encoding: str, name: str) -> str:
    content = file.read(most + 1)
    if len(content) > most:
        reason = f"larger than the {most} bytes that are read of such a file"
        raise OSError(errno.EFBIG, reason, name)
    return content.decode(encoding).replace("\r\n", "\n").replace("\r", "\n")
