"""A browser without windows, for tests of pages."""

import json
import os
import subprocess
from base64 import b64decode
from shutil import which

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")

BROWSER = next(filter(None, map(which, NAMES)), None)

needs_browser = pytest.mark.skipif(
    BROWSER is None, reason=f"needs a browser that runs headless: none of {', '.join(NAMES)}"
)


class Browser:
    """A browser with one page, which is driven; the requests and errors of the page are noted.

    Speaks the browser's own protocol over its file descriptors 3 and 4. It starts once for all
    tests of a process (fixture `browser`): a start takes about a second of CPU time.
    """

    def __init__(self, folder):
        self.requests, self.errors = [], []
        self._number, self._unread = 0, b""
        (theirs, ours), (back, reported) = os.pipe(), os.pipe()
        options = ["--headless", "--disable-gpu", "--no-sandbox", "--remote-debugging-pipe"]

        def connect():
            first, second = os.dup(theirs), os.dup(reported)  # which may be 3 and 4 themselves
            os.dup2(first, 3)
            os.dup2(second, 4)

        self._process = subprocess.Popen(  # with the descriptors that the browser expects
            [BROWSER, *options, f"--user-data-dir={folder}"],
            pass_fds=(3, 4),
            preexec_fn=connect,  # noqa: PLW1509 - no other threads here
            stderr=subprocess.DEVNULL,
        )
        os.close(theirs)
        os.close(reported)
        self._to, self._from = ours, back
        self._session = {}
        target = self._ask("Target.createTarget", url="about:blank")["targetId"]
        attached = self._ask("Target.attachToTarget", targetId=target, flatten=True)
        self._session = {"sessionId": attached["sessionId"]}
        for part in ("Network", "Page", "Runtime", "Log"):
            self._ask(f"{part}.enable")

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self._session = {}
        self._ask("Browser.close")
        self._process.wait(timeout=60.0)  # with all of its processes: their CPU time is counted
        os.close(self._to)
        os.close(self._from)

    def open(self, url, width, height=1000):
        """Show a page in a window of that many pixels, and wait until it is loaded."""
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self._ask("Emulation.setDeviceMetricsOverride", **size)
        self.requests, self.errors = [], []
        self._ask("Page.navigate", url=url)
        while self._receive().get("method") != "Page.loadEventFired":
            pass

    def run(self, script):
        """Return the value of a script, or of what it promises."""
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

    def print_pdf(self):
        """Return the page as it is printed, a file of PDF."""
        return b64decode(self._ask("Page.printToPDF")["data"])

    def _ask(self, method, **parameters):
        self._number += 1
        requested = {"id": self._number, "method": method, "params": parameters} | self._session
        os.write(self._to, json.dumps(requested).encode() + b"\0")
        while True:
            answer = self._receive()
            if answer.get("id") == self._number:
                assert "error" not in answer, answer
                return answer["result"]

    def _receive(self):
        """Return the next message; note what it says of requests and errors."""
        while b"\0" not in self._unread:
            part = os.read(self._from, 1 << 20)
            assert part, "the browser has gone"
            self._unread += part
        message, _, self._unread = self._unread.partition(b"\0")
        message = json.loads(message)
        about = message.get("params", {})
        if message.get("method") == "Network.requestWillBeSent":
            self.requests.append(about["request"]["url"])
        if message.get("method") == "Log.entryAdded":  # also what a policy of the page refuses
            self.errors.append(about["entry"]["text"])
        if message.get("method") == "Runtime.exceptionThrown":
            self.errors.append(about["exceptionDetails"]["text"])
        return message
