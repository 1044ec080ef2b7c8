"""A client of the live page that speaks viser's protocol, in place of a browser."""

from __future__ import annotations

import threading
import time
from collections import defaultdict
from collections.abc import Callable
from typing import Any

import msgspec
import viser
import zstandard
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

CAMERA = {
    "wxyz": [1.0, 0.0, 0.0, 0.0],
    "position": [1.0, 0.0, 0.0],
    "fov": 1.0,
    "near": 0.1,
    "far": 100.0,
    "image_height": 100,
    "image_width": 100,
    "look_at": [0.0, 0.0, 0.0],
    "up_direction": [0.0, 0.0, 1.0],
}


class LiveClient:
    """Keeps what it is told: `controls` by label, `placements` by scene node, properties `shown` by uuid."""

    def __init__(self, port: int) -> None:
        self.socket = connect(
            f"ws://127.0.0.1:{port}",
            subprotocols=[f"viser-v{viser.__version__}"],
            compression=None,
            max_size=None,
        )
        self.controls: dict[str, str] = {}
        # what stands still at its parent's place is not sent
        self.placements: dict[str, dict[str, Any]] = defaultdict(
            lambda: {"position": [0.0, 0.0, 0.0], "wxyz": [1.0, 0.0, 0.0, 0.0]}
        )
        self.shown: dict[str, dict[str, Any]] = {}
        self.heard = 0
        self.complete = False  # all that was there before us has come
        self.thread = threading.Thread(target=self.listen, daemon=True)
        self.thread.start()
        self.send("ViewerCameraMessage", **CAMERA)  # who sends none is no client yet
        self.wait_for(lambda: self.complete)

    def listen(self) -> None:
        try:
            for packet in self.socket:
                size = int.from_bytes(packet[8:16], "little")
                content = zstandard.ZstdDecompressor().decompressobj().decompress(packet[16 : 16 + size])
                for message in messages_in(msgspec.msgpack.decode(content)):
                    self.notice(message)
        except ConnectionClosed:
            pass

    def notice(self, message: dict[str, Any]) -> None:
        self.heard += 1
        self.complete |= message["type"] == "ReplayDoneMessage"
        kind = message["type"]
        if kind in ("SetPositionMessage", "SetOrientationMessage"):
            key = "position" if kind == "SetPositionMessage" else "wxyz"
            self.placements[message["name"]][key] = message[key]
        elif kind == "GuiUpdateMessage":
            self.shown.setdefault(message["uuid"], {}).update(message["updates"])
        elif kind.startswith("Gui") and "props" in message:
            self.shown.setdefault(message["uuid"], {}).update(message["props"], value=message.get("value"))
            if label := message["props"].get("label"):
                self.controls[label] = message["uuid"]

    def send(self, kind: str, **fields: Any) -> None:
        self.socket.send(msgspec.msgpack.encode({"type": kind, **fields}))

    def set(self, label: str, value: Any) -> None:
        """What a click on a control sends."""
        self.send("GuiUpdateMessage", uuid=self.controls[label], updates={"value": value})

    def value(self, label: str) -> Any:
        return self.shown[self.controls[label]]["value"]

    def drag(self, node: str, position: list[float], wxyz: list[float]) -> None:
        """What dragging a handle sends."""
        self.send("TransformControlsUpdateMessage", name=node, position=position, wxyz=wxyz, owner="")

    def reads(self, text: str) -> bool:
        """Whether the page says something."""
        return any(text in str(props.get("_markdown", "")) for props in self.shown.values())

    def wait_for(self, condition: Callable[[], Any], seconds: float = 10) -> None:
        wait_for(condition, seconds)

    def vanish(self) -> None:
        """Leave without a word."""
        self.socket.socket.close()


def wait_for(condition: Callable[[], Any], seconds: float = 10) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, "it never happened"
        time.sleep(0.02)


def messages_in(content: Any) -> list[dict[str, Any]]:
    """All messages of a packet, however they are nested."""
    if isinstance(content, dict):
        if "type" in content:
            return [content]
        return [each for value in content.values() for each in messages_in(value)]
    if isinstance(content, list):
        return [each for value in content for each in messages_in(value)]
    return []
