"""A headless Chromium that tests drive over its DevTools protocol.

The binary is that of the npm package @sparticuz/chromium, pinned in viewer/; `make viewer-tests` unpacks it.
"""

from __future__ import annotations

import base64
import itertools
import json
import os
import re
import subprocess
import time
import urllib.request
from pathlib import Path
from typing import Any

from websockets.sync.client import connect

UNPACKED = Path(__file__).parents[2] / "build" / "chromium"
FLAGS = (
    "--headless=shell",
    "--no-sandbox",  # works as root, and in containers without user namespaces
    "--no-zygote",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",  # WebGL without a graphics card
    "--font-render-hinting=none",
    "--no-first-run",
    "--disable-background-networking",
    "--remote-debugging-port=0",
)


class Browser:
    """A running Chromium."""

    def __init__(self, profile: Path) -> None:
        binary = UNPACKED / "chromium"
        if not binary.exists():
            raise FileNotFoundError(f"{binary} is missing: run `make viewer-tests`")
        libraries = f"{UNPACKED}/al2023/lib:{os.environ.get('LD_LIBRARY_PATH', '')}"
        # the package's fonts, if the machine has none of its own
        fonts = {} if Path("/etc/fonts/fonts.conf").exists() else {"FONTCONFIG_PATH": str(UNPACKED / "fonts")}
        self.log = (profile / "chromium.log").open("w+")
        self.process = subprocess.Popen(
            [str(binary), *FLAGS, f"--user-data-dir={profile}"],
            stderr=self.log,
            # a machine whose locale is C has no language that JavaScript knows
            env={
                **os.environ,
                "LD_LIBRARY_PATH": libraries,
                "LANG": "en_US.UTF-8",
                "LC_ALL": "en_US.UTF-8",
                **fonts,
            },
        )
        self.address = self.wait_for_address(profile / "chromium.log")

    def wait_for_address(self, log: Path) -> str:
        deadline = time.monotonic() + 30
        while time.monotonic() < deadline and self.process.poll() is None:
            if found := re.search(r"DevTools listening on ws://([\d.:]+)/", log.read_text(errors="replace")):
                return found[1]
            time.sleep(0.05)
        raise RuntimeError(f"Chromium did not start: {log.read_text(errors='replace')[-2000:]}")

    def open(self, url: str = "about:blank", **view: Any) -> Page:
        """A new page, at `url`; `view` as in Page.view."""
        new = urllib.request.Request(f"http://{self.address}/json/new?about:blank", method="PUT")
        with urllib.request.urlopen(new) as answer:
            page = Page(json.load(answer)["webSocketDebuggerUrl"])
        page.view(**view)
        if url != "about:blank":
            page.go(url)
        return page

    def close(self) -> None:
        self.process.kill()  # it has nothing to save
        self.process.wait()
        self.log.close()


class Page:
    """One tab. `requests` lists what it asked any network for, `complaints` what went wrong in it."""

    def __init__(self, address: str) -> None:
        self.socket = connect(address, max_size=None, compression=None)
        self.numbers = itertools.count(1)
        self.requests: list[str] = []
        self.complaints: list[str] = []
        self.loaded = False
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")

    def call(self, method: str, **params: Any) -> dict[str, Any]:
        number = next(self.numbers)
        self.socket.send(json.dumps({"id": number, "method": method, "params": params}))
        while (message := json.loads(self.socket.recv(timeout=60))).get("id") != number:
            self.notice(message)
        if "error" in message:
            raise RuntimeError(f"{method}: {message['error']['message']}")
        return message["result"]

    def notice(self, event: dict[str, Any]) -> None:
        params = event.get("params", {})
        match event.get("method"):
            case "Page.loadEventFired":
                self.loaded = True
            case "Network.requestWillBeSent":
                self.request(params["request"]["url"])
            case "Network.webSocketCreated":
                self.request(params["url"])
            case "Runtime.exceptionThrown":
                details = params["exceptionDetails"]
                self.complaints.append(details.get("exception", {}).get("description", details["text"]))
            case "Runtime.consoleAPICalled" if params["type"] in ("error", "warning", "assert"):
                self.complaints.append(
                    str([each.get("value", each.get("description")) for each in params["args"]])
                )
            case "Log.entryAdded" if params["entry"]["level"] in ("error", "warning"):
                self.complaints.append(params["entry"]["text"])

    def request(self, url: str) -> None:
        if not url.startswith(("file:", "data:", "blob:")):
            self.requests.append(url)

    def go(self, url: str) -> None:
        self.loaded = False
        self.call("Page.navigate", url=url)
        deadline = time.monotonic() + 60
        while not self.loaded and time.monotonic() < deadline:
            self.settle()
        assert self.loaded, f"{url} did not load"
        self.settle(3)

    def view(self, width: int = 1280, height: int = 800, dark: bool = False, scale: float = 1) -> None:
        """The window [px], and what the reader's system prefers."""
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=scale,
            mobile=width < 600,
        )
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.call("Emulation.setEmulatedMedia", features=[scheme])

    def run(self, script: str) -> Any:
        """The value of a JavaScript expression, awaited."""
        answer = self.call(
            "Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True, userGesture=True
        )
        if "exceptionDetails" in answer:
            raise RuntimeError(f"{script}: {answer['exceptionDetails']['exception'].get('description')}")
        return answer["result"].get("value")

    def settle(self, frames: int = 1) -> None:
        """Wait until the page has drawn what changed."""
        for _ in range(frames):
            self.run("new Promise(done => requestAnimationFrame(() => setTimeout(done, 0)))")

    def wait_for(self, condition: str, seconds: float = 10) -> None:
        """Wait until a JavaScript expression is true."""
        deadline = time.monotonic() + seconds
        while not self.run(condition):
            assert time.monotonic() < deadline, f"never true: {condition}"
            time.sleep(0.02)

    def press(self, key: str, shift: bool = False) -> None:
        text = {"text": " "} if key == " " else {}
        code = "Space" if key == " " else key
        for kind in ("keyDown", "keyUp"):
            down = text if kind == "keyDown" else {}
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=code, modifiers=8 * shift, **down)
        self.settle()

    def mouse(self, kind: str, x: float, y: float, held: bool = False) -> None:
        """`kind`: Moved, Pressed or Released."""
        button = "left" if held or kind != "Moved" else "none"
        self.call(
            "Input.dispatchMouseEvent",
            type=f"mouse{kind}",
            x=x,
            y=y,
            button=button,
            buttons=int(held or kind == "Pressed"),
            clickCount=int(kind != "Moved"),
        )

    def click(self, selector: str) -> None:
        x, y = self.middle_of(selector)
        for kind in ("Moved", "Pressed", "Released"):
            self.mouse(kind, x, y)
        self.settle()

    def middle_of(self, selector: str) -> tuple[float, float]:
        """Middle of an element in the window [px], after bringing it into view."""
        box = self.run(
            f"(() => {{ const e = document.querySelector({json.dumps(selector)});"
            " e.scrollIntoView({block: 'center', behavior: 'instant'});"
            " const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; })()"
        )
        self.settle(2)
        return box[0], box[1]

    def picture(self, whole: bool = False) -> bytes:
        """A PNG of the window, or of the whole page."""
        self.settle(2)
        answer = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=whole)
        return base64.b64decode(answer["data"])

    def close(self) -> None:
        self.call("Page.close")
        self.socket.close()
