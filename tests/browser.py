"""A browser without windows, for tests of pages."""

import base64
import hashlib
import json
import os
import re
import subprocess
from html import unescape
from shutil import which

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")

BROWSER = next(filter(None, map(which, NAMES)), None)

needs_browser = pytest.mark.skipif(
    BROWSER is None, reason=f"needs a browser that runs headless: none of {', '.join(NAMES)}"
)

# A browser window has a least width; a frame inside has none.
FRAME = """<!DOCTYPE html><body style="margin:0"><iframe src="page.html" width="{width}"
height="{height}" style="border:0"></iframe><pre></pre><script>addEventListener("message", event =>
document.querySelector("pre").textContent = JSON.stringify(event.data));</script></body>"""


def browse(folder, *options):
    """Run the browser, without network or a profile of the user's."""
    always = ["--headless", "--disable-gpu", "--virtual-time-budget=20000", "--hide-scrollbars"]
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        always.append("--no-sandbox")
    profile = f"--user-data-dir={folder / 'profile'}"
    return subprocess.run(
        [BROWSER, *always, profile, *options],
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    ).stdout


def reported_by(html, script, folder, width, height=3000):
    """What a script at the end of a page posts to the window around it, at a width in pixels."""
    page = html.replace("</body>", f"<script>{script}</script></body>")
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    page = page.replace("script-src 'none'", f"script-src 'sha256-{digest}'")
    (folder / "page.html").write_text(page, "utf-8")
    frame = folder / "frame.html"
    frame.write_text(FRAME.format(width=width, height=height), "utf-8")
    size = f"--window-size={max(width, 500)},{height}"
    shown = browse(folder, size, "--dump-dom", frame.as_uri())
    return json.loads(unescape(re.search(r"<pre>(.*?)</pre>", shown, re.DOTALL).group(1)))


class Tab:
    """A page in a browser that is driven: keys are pressed, requests and errors are noted.

    Speaks the browser's own protocol over its file descriptors 3 and 4.
    """

    def __init__(self, url, folder, width, height=1000):
        self.requests, self.errors, self._number = [], [], 0
        (theirs, ours), (back, reported) = os.pipe(), os.pipe()
        options = ["--headless", "--disable-gpu", "--no-sandbox", "--remote-debugging-pipe"]
        profile = f"--user-data-dir={folder / 'profile'}"

        def connected():
            first, second = os.dup(theirs), os.dup(reported)  # which may be 3 and 4 themselves
            os.dup2(first, 3)
            os.dup2(second, 4)

        self._process = subprocess.Popen(  # with the descriptors that the browser expects
            [BROWSER, *options, profile],
            pass_fds=(3, 4),
            preexec_fn=connected,  # noqa: PLW1509 - no other threads here
            stderr=subprocess.DEVNULL,
        )
        os.close(theirs)
        os.close(reported)
        self._to, self._from = os.fdopen(ours, "wb"), os.fdopen(back, "rb")
        self._session = {}
        target = self._ask("Target.createTarget", url="about:blank")["targetId"]
        attached = self._ask("Target.attachToTarget", targetId=target, flatten=True)
        self._session = {"sessionId": attached["sessionId"]}
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self._ask("Emulation.setDeviceMetricsOverride", **size)
        for part in ("Network", "Page", "Runtime", "Log"):
            self._ask(f"{part}.enable")
        self._ask("Page.navigate", url=url)
        while not self.run("location.href != 'about:blank' && document.readyState == 'complete'"):
            pass

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self._process.kill()
        self._process.wait()
        self._to.close()
        self._from.close()

    def run(self, script):
        """The value of a script, or of what it promises."""
        found = self._ask(
            "Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True
        )
        assert "exceptionDetails" not in found, found
        return found["result"].get("value")

    def press(self, key, code):
        """Press and release a key."""
        about = {"key": key, "code": key, "windowsVirtualKeyCode": code}
        for kind in ("rawKeyDown", "keyUp"):
            self._ask("Input.dispatchKeyEvent", type=kind, **about)

    def _ask(self, method, **parameters):
        self._number += 1
        requested = {"id": self._number, "method": method, "params": parameters} | self._session
        self._to.write(json.dumps(requested).encode() + b"\0")
        self._to.flush()
        while True:
            answer = json.loads(self._read())
            if answer.get("method") == "Network.requestWillBeSent":
                self.requests.append(answer["params"]["request"]["url"])
            if answer.get("method") == "Log.entryAdded":  # also what a policy of the page refuses
                self.errors.append(answer["params"]["entry"]["text"])
            if answer.get("method") == "Runtime.exceptionThrown":
                self.errors.append(answer["params"]["exceptionDetails"]["text"])
            if answer.get("id") == self._number:
                assert "error" not in answer, answer
                return answer["result"]

    def _read(self):
        reported = bytearray()
        while (one := self._from.read(1)) != b"\0":
            assert one, "the browser has gone"
            reported += one
        return reported
