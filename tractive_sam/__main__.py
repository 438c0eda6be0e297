"""``python -m tractive_sam``, equivalent to ``tractive-sam``."""

from tractive_sam.cli import main

if __name__ == "__main__":
    main()
