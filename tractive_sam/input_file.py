"""Safe input: regular files only, up to a size limit."""

import codecs
import errno
import os
import stat
import sys
from io import BufferedReader
from os import PathLike
from typing import BinaryIO


def open_regular(path: str | PathLike[str]) -> BufferedReader:
    """Open a regular file for reading bytes; raise an OSError for pipes, devices and folders.

    Other files are refused: a device may have no end, and a named pipe may wait for ever.

    Raises
    ------
    OSError
        If the file does not exist, may not be read, or is no regular file.
    """
    # Without O_NONBLOCK, a named pipe without a writer would block here.
    flags = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)  # not on every system
    descriptor = os.open(path, os.O_RDONLY | flags)
    try:
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            reason = "a directory, device or pipe, not a regular file"
            raise OSError(errno.EINVAL, reason, os.fspath(path))
        return os.fdopen(descriptor, "rb")
    except BaseException:
        os.close(descriptor)
        raise


def read_text(path: str | PathLike[str], max_bytes: int, encoding: str | None = "utf-8") -> str:
    """Return the text of a regular file or a pipe; raise an OSError above `max_bytes`.

    Line ends are those of Unix; a byte-order mark and a DOS end mark (byte 26) are left out.

    Parameters
    ----------
    path : path-like
        The file.
    max_bytes : int
        Largest size of the file.
    encoding : str, optional
        Encoding of a text without a byte-order mark; None for UTF-8, UTF-16 or Windows-1252,
        whichever fits.

    Raises
    ------
    OSError
        See `open_regular`; also if the file is larger than `max_bytes`.
    UnicodeDecodeError
        If the bytes are no text in this encoding.
    """
    piped = os.fspath(path).startswith(("/dev/stdin", "/dev/fd/", "/proc/self/fd/"))
    with open(path, "rb") if piped else open_regular(path) as file:
        return _read_limited(file, max_bytes, encoding, os.fspath(path))


def read_piped(max_bytes: int, encoding: str = "utf-8") -> str:
    """Return the text of the standard input; raise an OSError above `max_bytes`.

    Parameters
    ----------
    max_bytes, encoding
        See `read_text`.

    Raises
    ------
    OSError
        If the input is larger than `max_bytes`.
    UnicodeDecodeError
        If the bytes are no text in this encoding.
    """
    return _read_limited(sys.stdin.buffer, max_bytes, encoding, "standard input")


def _read_limited(file: BinaryIO, max_bytes: int, encoding: str | None, name: str) -> str:
    """Return the text of an open file with Unix line ends; raise an OSError above `max_bytes`."""
    content = file.read(max_bytes + 1)
    if len(content) > max_bytes:
        reason = f"larger than the limit of {max_bytes} bytes for a file of this kind"
        raise OSError(errno.EFBIG, reason, name)
    text = content.decode(_find_encoding(content, encoding)).removeprefix("\ufeff")
    return text.rstrip("\0\x1a").replace("\r\n", "\n").replace("\r", "\n")


def _find_encoding(content: bytes, otherwise: str | None) -> str:
    """Return the encoding by a byte-order mark, else as given, or as the bytes can be read."""
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    if otherwise:
        return otherwise
    # In UTF-16, every other byte of digits and Latin letters is zero.
    zeros = [content[start:4000:2].count(0) for start in (0, 1)]
    if max(zeros) > len(content[:4000]) // 4:
        return "utf-16-be" if zeros[0] > zeros[1] else "utf-16-le"
    try:
        content.decode("utf-8")
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8"
