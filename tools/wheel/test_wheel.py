"""The wheel as a user gets it: installed where there is nothing but Python, no compiler, no Node.js, no checkout."""

from __future__ import annotations

import http.client
import importlib
import os
import re
import shutil
import signal
import subprocess
import sys
import tarfile
import zipfile
from collections.abc import Callable
from email.parser import HeaderParser
from pathlib import Path

import pytest

DIST = Path(__file__).resolve().parents[2] / "dist"
# On disk, with NumPy.
LARGEST_MB = 130
# Extras of the checkout, not of users: `make test` and `make bench` install and use them.
OF_THE_CHECKOUT = {"bench", "test"}
# What each extra is for, and the file that comes of it.
EXTRAS: dict[str, list[tuple[list[str], str]]] = {
    "figures": [
        (["demo", "-o", "out"], "out/chair.png"),
        (["render", "chair.obj", "-o", "drawn.png"], "drawn.png"),
    ],
}
# How pip reaches its index here.
FOR_PIP = {
    name: value
    for name, value in os.environ.items()
    if name.startswith(("PIP_", "SSL_")) or name.lower().endswith("_proxy")
}


@pytest.fixture(scope="session")
def wheel() -> Path:
    """The one that `make wheels` built."""
    wheels = list(DIST.glob("neuralmls-*.whl"))
    assert len(wheels) == 1, f"expected one wheel in {DIST}: make wheels"
    return wheels[0]


@pytest.fixture(scope="session")
def coreutils(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with what every Unix has, for PATH."""
    folder = tmp_path_factory.mktemp("bin")
    for name in ("cat", "ls", "mkdir", "rm", "sh", "true", "uname", "env"):
        (folder / name).symlink_to(shutil.which(name) or pytest.fail(f"no {name} here"))
    return folder


class Installed:
    """A new environment with the wheel, in a folder of its own."""

    def __init__(self, wheel: Path, folder: Path, coreutils: Path, extra: str = "", *, alone: bool = False) -> None:
        self.folder = folder
        subprocess.run([sys.executable, "-m", "venv", folder / "venv"], check=True)
        self.environment = {"PATH": f"{folder / 'venv/bin'}:{coreutils}", "HOME": str(folder), "LANG": "C.UTF-8"}
        for tool in ("cc", "gcc", "c++", "clang", "cargo", "rustc", "node", "npm", "zig", "make"):
            assert shutil.which(tool, path=self.environment["PATH"]) is None
        before = self.megabytes()
        what = f"{wheel}[{extra}]" if extra else str(wheel)
        self.run("pip", "install", "--quiet", "--only-binary", ":all:", *["--no-deps"] * alone, what, **FOR_PIP)
        self.added = self.megabytes() - before
        name = f"[{extra}]" if extra else "alone" if alone else "with NumPy and what else it needs"
        print(f"measured: the wheel {name} takes {self.added:.1f} MB installed")

    def megabytes(self) -> float:
        """What the environment takes on disk."""
        return sum(path.lstat().st_blocks * 512 for path in (self.folder / "venv").rglob("*")) / 1e6

    def run(self, *command: str, **more: str) -> str:
        """Run a program of the environment, and return what it prints."""
        ran = subprocess.run(
            command,
            cwd=self.folder,
            env=self.environment | more,
            capture_output=True,
            text=True,
            timeout=600,
            check=False,
        )
        assert ran.returncode == 0, f"{' '.join(command)}: {ran.stdout}{ran.stderr}"
        return ran.stdout


@pytest.fixture(scope="session")
def install(wheel: Path, coreutils: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Installed]:
    """Install the wheel anew."""
    return lambda *extra, **options: Installed(wheel, tmp_path_factory.mktemp("empty"), coreutils, *extra, **options)


@pytest.fixture(scope="session")
def plain(install: Callable[..., Installed]) -> Installed:
    """The wheel without extras, and a sample to work on."""
    installed = install()
    installed.run("neuralmls", "sample", "chair", "-o", "chair.obj")
    return installed


def test_one_wheel_serves_every_python_and_has_the_editor_and_all_licences(wheel):
    assert re.fullmatch(r"neuralmls-[\d.]+-cp311-abi3-manylinux_2_28_x86_64\.whl", wheel.name)
    print(f"measured: {wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB")
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        static = [name for name in names if name.startswith("neuralmls/editor_server/static/")]
        assert "neuralmls/editor_server/static/index.html" in static
        assert {".js", ".css", ".wasm"} <= {Path(name).suffix for name in static}
        licences = {Path(name).name: archive.read(name).decode() for name in names if ".dist-info/licenses/" in name}
        for name in names:
            here = [path for path in (Path.home(), DIST.parent) if f"{path}/".encode() in archive.read(name)]
            assert not here, f"{name} names {here}"
    assert "Permission is hereby granted" in licences["LICENSE"]
    for part in ("rayon", "numpy", "wasm-bindgen", "the Rust standard library", "preact", "three", "three-mesh-bvh"):
        assert re.search(rf"^{part}( \d.*)?$", licences["LICENSE-THIRD-PARTY.txt"], re.MULTILINE), part


def test_the_sources_have_what_a_wheel_is_built_from():
    [archive] = DIST.glob("neuralmls-*.tar.gz")
    with tarfile.open(archive) as sources:
        names = {name.partition("/")[2] for name in sources.getnames()}
    assert names >= {
        "Cargo.lock",
        "LICENSE",
        "LICENSE-THIRD-PARTY.txt",
        "crates/python/Cargo.toml",
        "python/neuralmls/editor_server/static/index.html",
        "tools/wheel/backend.py",
    }


def test_no_wheel_is_built_without_the_editor(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(Path(__file__).parent)
    backend = importlib.import_module("backend")
    monkeypatch.setattr(backend, "ROOT", tmp_path)
    for build in (backend.build_wheel, backend.build_sdist):
        with pytest.raises(SystemExit, match=r"static/index\.html is missing.*make wheels"):
            build(str(tmp_path))


def test_it_is_small(install, plain):
    assert install(alone=True).added < 20
    assert plain.added < LARGEST_MB


def test_it_says_its_version(plain, wheel):
    assert wheel.name.split("-")[1] in plain.run("neuralmls", "--version")


def test_it_bends_a_sample(plain):
    plain.run("neuralmls", "deform", "chair.obj", "--points", "chair.points.json", "-o", "bent.obj")
    assert (plain.folder / "bent.obj").read_text() != (plain.folder / "chair.obj").read_text()


def test_the_demo_runs_without_pictures(plain):
    plain.run("neuralmls", "demo", "-o", "out")
    assert (plain.folder / "out" / "chair-neural.obj").is_file()


def test_the_editor_opens_and_stops(plain):
    command = ["neuralmls", "edit", "chair.obj", "--points", "chair.points.json", "--no-browser"]
    with subprocess.Popen(
        [plain.folder / "venv/bin" / command[0], *command[1:]],
        cwd=plain.folder,
        env=plain.environment,
        stderr=subprocess.PIPE,
    ) as running:
        assert running.stderr is not None
        found = re.search(r"http://127\.0\.0\.1:(\d+)(/\S+/)\?session", running.stderr.readline().decode())
        assert found
        for path, start in [("?session", b"<!doctype html>"), ("session/0", (plain.folder / "chair.obj").read_bytes())]:
            connection = http.client.HTTPConnection("127.0.0.1", int(found[1]), timeout=30)
            connection.request("GET", found[2] + path)
            assert connection.getresponse().read().lower().startswith(start.lower())
            connection.close()
        running.send_signal(signal.SIGINT)
        assert running.wait(timeout=30) == 0


def test_every_extra_of_users_is_tried(wheel):
    with zipfile.ZipFile(wheel) as archive:
        [metadata] = [name for name in archive.namelist() if name.endswith(".dist-info/METADATA")]
        extras = HeaderParser().parsestr(archive.read(metadata).decode()).get_all("Provides-Extra", [])
    assert set(extras) - OF_THE_CHECKOUT == set(EXTRAS)


@pytest.mark.parametrize("extra", EXTRAS)
def test_an_extra_brings_what_its_commands_need(install, extra):
    installed = install(extra)
    installed.run("neuralmls", "sample", "chair", "-o", "chair.obj")
    for command, result in EXTRAS[extra]:
        installed.run("neuralmls", *command)
        assert (installed.folder / result).exists()
