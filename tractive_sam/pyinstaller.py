"""Folder of the hook with which PyInstaller bundles this package into a program."""

from pathlib import Path


def find_hook_folders() -> list[str]:
    """Return the folders of PyInstaller hooks of this package (entry point)."""
    return [str(Path(__file__).with_name("pyinstaller_hooks"))]
