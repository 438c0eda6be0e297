"""``python -m tractive_sam``, the same as ``tractive-sam``."""

from tractive_sam.cli import main

if __name__ == "__main__":
    main()
