"""Run the example of the README and store its picture.

Page: README.md
"""

import os
import re
import tempfile
from pathlib import Path

from timing import RESULTS

README = Path(__file__).parents[1] / "README.md"


def main():
    code = re.search(r"```python\n(.*?)```", README.read_text(), re.DOTALL).group(1)
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        exec(compile(code, "README.md", "exec"), {})
        picture = RESULTS / "traction.png"
        picture.write_bytes(Path("traction.png").read_bytes())
    print(f"written: {picture}")


if __name__ == "__main__":
    main()
