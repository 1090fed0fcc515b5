"""How binaries of each platform of the release set are compiled and run on this machine."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

from .conftest import HEADERS, ROOT, need

FOLDER = ROOT / "target/platforms"
LINUX64, AARCH64, WIN64 = "linux64", "aarch64-linux", "win64"
STEPS = Path(__file__).with_name("steps.c")

# Wine 8 lacks the function by which the standard library of Rust seeds its hash maps
RANDOM = """
__declspec(dllexport) int ProcessPrng(unsigned char *bytes, unsigned long long count) {
    for (unsigned long long k = 0; k < count; k++) bytes[k] = (unsigned char)(k * 151 + 7);
    return 1;
}
"""


@dataclass(frozen=True)
class Machine:
    """Compiler of C programs for a platform, and the program that runs them."""

    name: str
    extension: str
    compiler: tuple[str, ...]
    emulator: tuple[str, ...] = ()
    environment: dict[str, str] = field(default_factory=dict)

    def path(self, path: Path) -> str:
        """Return a path of this machine as the platform sees it."""
        return f"Z:{path}".replace("/", "\\") if self.name == WIN64 else str(path)

    def uri(self, path: Path) -> str:
        """Return the URI of a folder as the platform sees it."""
        return f"file:///Z:{path}" if self.name == WIN64 else path.as_uri()

    def compile(self, folder: Path) -> Path:
        """Compile the program that replays a recording."""
        program = folder / f"steps-{self.name}.exe"
        flags = ["-std=gnu11", "-O1", "-Wall", "-Wextra", "-Werror", "-I", str(HEADERS)]
        libraries = [] if self.name == WIN64 else ["-ldl", "-lm"]
        command = [*self.compiler, *flags, str(STEPS), "-o", str(program), *libraries]
        subprocess.run(command, check=True, env=os.environ | self.environment)
        if self.name == WIN64:
            (folder / "random.c").write_text(RANDOM)
            stub = [*self.compiler, "-shared", str(folder / "random.c"), "-o"]
            library = str(folder / "bcryptprimitives.dll")
            subprocess.run([*stub, library], check=True, env=os.environ | self.environment)
        return program

    def run(self, program: Path, *words: str) -> subprocess.CompletedProcess[str]:
        """Run a program to its end."""
        command = [*self.emulator, str(program), *words]
        environment = os.environ | self.environment
        return subprocess.run(command, env=environment, capture_output=True, text=True, check=False)


def machine(name: str) -> Machine:
    """Return what runs a platform here; the test is skipped where it is missing."""
    return {LINUX64: linux64, AARCH64: aarch64, WIN64: win64}[name]()


def linux64() -> Machine:
    """Return this machine."""
    return Machine(LINUX64, "so", (need("cc", shutil.which("cc")),))


def aarch64() -> Machine:
    """Return QEMU with the C library of ARM Linux."""
    qemu = unpacked("qemu/usr/bin/qemu-aarch64")
    system = unpacked("aarch64/lib/aarch64-linux-gnu/libc.so.6").parents[2]
    compiler = (sys.executable, "-m", "ziglang", "cc", "-target", "aarch64-linux-gnu.2.17")
    emulator = (str(qemu), "-U", "LD_LIBRARY_PATH", "-L", str(system))
    return Machine(AARCH64, "so", compiler, emulator, libraries("qemu"))


def win64() -> Machine:
    """Return Wine with a disk of its own."""
    wine = unpacked("wine/usr/lib/wine/wine64")
    compiler = (str(unpacked("mingw/usr/bin/x86_64-w64-mingw32-gcc-win32")),)
    variables = libraries("wine", "mingw") | {
        "WINEPREFIX": str(FOLDER / "windows"),
        "WINEDEBUG": "-all",
        "WINEDLLOVERRIDES": "bcryptprimitives=n;mscoree,mshtml=",
    }
    if not (FOLDER / "windows").exists():
        # the first program makes the disk, with words of its own; what is run matters not
        boot = [str(wine), "wineboot", "--init"]
        subprocess.run(boot, check=False, env=os.environ | variables, capture_output=True)
    return Machine(WIN64, "dll", compiler, (str(wine),), variables)


def unpacked(path: str) -> Path:
    """Return a file that `cargo xtask test --platforms` fetched."""
    file = FOLDER / path
    need(file.name, str(file) if file.exists() else None)
    return file


def libraries(*roots: str) -> dict[str, str]:
    """Return the variable that names the libraries of unpacked packages."""
    folders = [str(FOLDER / root / "usr/lib/x86_64-linux-gnu") for root in roots]
    return {"LD_LIBRARY_PATH": ":".join(folders)}
