"""Installs the peers of `tope bench --peers`, each into an environment of its own: make peers [PEERS="tsid
placo"].

Their dependencies contradict each other and tope's. What cannot be installed leaves its reason in
absent.txt, for the benchmark to say.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import sysconfig
import venv
from pathlib import Path

HERE = Path(__file__).parent
ENVIRONMENTS = HERE.parents[1] / ".venv-peers"
WITH_CPP = ("roboplan", "tsid")
REASON_LENGTH = 200


class InstallError(Exception):
    """Why."""


def install(name: str) -> None:
    """Install a peer unless what is there is what its requirements say."""
    requirements = HERE / "requirements" / f"{name}.txt"
    home = ENVIRONMENTS / name
    ready = home / "requirements.txt"
    if not ready.is_file() or ready.read_bytes() != requirements.read_bytes():
        shutil.rmtree(home, ignore_errors=True)
        venv.create(home, with_pip=True)
        pip = [home / "bin" / "python", "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        # what is built from source is built against the same versions
        constraint = {"PIP_CONSTRAINT": str(requirements), "PIP_BUILD_CONSTRAINT": str(requirements)}
        call([*pip, "-r", requirements], constraint)
        shutil.copyfile(requirements, ready)
    if name in WITH_CPP:
        build(name, home)


def build(name: str, home: Path) -> None:
    """Build a peer's C++ program against its environment."""
    say = "import importlib.metadata, sys; print(importlib.metadata.version(sys.argv[1]))"
    version = call([home / "bin" / "python", "-c", say, name]).strip()
    packages = sysconfig.get_path("purelib", vars={"base": str(home)})
    cmake = Path(sys.executable).parent / "cmake"
    ninja = Path(sys.executable).parent / "ninja"
    options = {
        "CMAKE_MAKE_PROGRAM": ninja,
        "CMAKE_PREFIX_PATH": f"{packages}/cmeel.prefix",
        "PEER": name,
        "PEER_VERSION": version,
    }
    defined = [f"-D{key}={value}" for key, value in options.items()]
    call([cmake, "-S", HERE / "cpp", "-B", home / "build", "-G", "Ninja", *defined])
    call([cmake, "--build", home / "build"])


def call(command: list[str | Path], environment: dict[str, str] | None = None) -> str:
    """Run a command; raises InstallError with what it said that looks like the reason."""
    done = subprocess.run(
        list(map(str, command)),
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | (environment or {}),
    )
    if done.returncode != 0:
        lines = [line.strip() for line in (done.stdout + done.stderr).splitlines() if line.strip()]
        told = (
            [line for line in lines if "error" in line.lower()] or lines or [f"exit code {done.returncode}"]
        )
        raise InstallError(told[-1][:REASON_LENGTH])
    return done.stdout


def main() -> None:
    """Install the peers named, or all of them."""
    names = sys.argv[1:] or sorted(file.stem for file in (HERE / "requirements").glob("*.txt"))
    for name in names:
        absent = ENVIRONMENTS / name / "absent.txt"
        try:
            print(f"{name}: ", end="", flush=True)
            absent.unlink(missing_ok=True)
            install(name)
            print("ready")
        except InstallError as reason:
            print(f"absent: {reason}")
            absent.parent.mkdir(parents=True, exist_ok=True)
            absent.write_text(f"{reason}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
