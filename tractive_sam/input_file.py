"""Safe input: regular files only, up to a size limit."""

import codecs
import csv
import errno
import os
import stat
import sys
from collections.abc import Iterator, Sequence
from os import PathLike
from typing import BinaryIO


def open_regular(path: str | PathLike[str]) -> BinaryIO:
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


def read_text(path: str | PathLike[str], max_bytes: int, encoding: str = "utf-8") -> str:
    """Return the text of a regular file or a pipe; raise an OSError above `max_bytes`.

    Parameters
    ----------
    path : path-like
        The file.
    max_bytes : int
        Largest size of the file.
    encoding : str
        Encoding of a text without a byte-order mark.

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


def read_columns(path: str | PathLike[str], max_bytes: int = 2**26) -> dict[str, list[str]]:
    """Return the cells of a text file by column; separators are semicolons, tabs or commas.

    If columns are separated by semicolons or tabs, a comma is a decimal sign. Empty lines and lines
    that begin with # are skipped.

    Parameters
    ----------
    path : path-like
        The file.
    max_bytes : int
        Largest size of the file.

    Returns
    -------
    dict of str to list of str
        Cells by the name of their column.

    Raises
    ------
    OSError, UnicodeDecodeError
        See `read_text`.
    ValueError
        If rows differ in length, or there is no header row.
    """
    lines = [*_content(read_text(path, max_bytes, "utf-8-sig").splitlines())]
    if not lines:
        raise ValueError("no header row")
    separator = next((character for character in ";\t" if character in lines[0][1]), ",")
    rows = [
        [cell.strip() for cell in row]
        for row in csv.reader([line for _, line in lines], delimiter=separator)
    ]
    header, body = rows[0], rows[1:]
    for (line, _), row in zip(lines[1:], body, strict=True):
        if len(row) != len(header):
            raise ValueError(f"line {line} has {len(row)} cells, and the header {len(header)}")
    if len(set(header)) < len(header):
        raise ValueError(f"a column name occurs twice in {', '.join(header)}")
    if separator != ",":
        body = [[cell.replace(",", ".") for cell in row] for row in body]
    return {name: [row[k] for row in body] for k, name in enumerate(header)}


def _content(lines: Sequence[str]) -> Iterator[tuple[int, str]]:
    """Yield (line number, line) of the lines that are neither empty nor comments."""
    for number, line in enumerate(lines, 1):
        if line.strip() and not line.lstrip().startswith("#"):
            yield number, line


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


def _read_limited(file: BinaryIO, max_bytes: int, encoding: str, name: str) -> str:
    """Return the text of an open file with Unix line ends; raise an OSError above `max_bytes`."""
    content = file.read(max_bytes + 1)
    if len(content) > max_bytes:
        reason = f"larger than the limit of {max_bytes} bytes for a file of this kind"
        raise OSError(errno.EFBIG, reason, name)
    # A byte-order mark, as editors of Windows write it, states the encoding.
    marks = {codecs.BOM_UTF8: "utf-8-sig"}
    marks |= dict.fromkeys((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE), "utf-16")
    encoding = next((marks[mark] for mark in marks if content.startswith(mark)), encoding)
    return content.decode(encoding).replace("\r\n", "\n").replace("\r", "\n")
