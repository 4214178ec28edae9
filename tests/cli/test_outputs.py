"""Where a command cannot or should not write: nothing there changes, and no half of a file is left."""

from __future__ import annotations

import json
import os
import signal
import sys
import time

import pytest

import neuralmls as nm

QUICK = ("--weights", "inverse-distance", "-q")
DEFORM = ("deform", "shape.obj", "--points", "points.csv", "--move", "top=0,1,0", *QUICK)


def test_existing_output_is_refused_without_force(refused, run, here):
    (here / "out.obj").write_text("precious")
    refused(2, *DEFORM, "-o", "out.obj", words=("out.obj", "--force"))
    assert run(*DEFORM, "-o", "out.obj", "--force").code == 0
    assert nm.read("out.obj").positions[:, 1].max() > 2.5


def test_output_equal_to_input_is_refused_without_force(refused, run, here):
    (here / "folder").mkdir()
    for name in ("shape.obj", "folder/../shape.obj", here / "shape.obj"):
        refused(2, *DEFORM, "-o", name, words=("the input itself", "--force"))
    (here / "link.obj").symlink_to("shape.obj")
    refused(2, *DEFORM, "-o", "link.obj", words=("the input itself",))
    refused(2, "points", "points.csv", "-o", "points.csv", words=("the input itself",))
    assert run(*DEFORM, "-o", "shape.obj", "--force").code == 0
    assert nm.read("shape.obj").positions[:, 1].max() > 2.5


def test_output_of_another_format_is_refused(refused):
    refused(2, *DEFORM, "-o", "out.ply", words=("out.ply: expected a name that ends in .obj, for a bent OBJ file (",))
    refused(2, *DEFORM, "-o", "out", words=(".obj",))


def test_companions_go_along_and_those_of_other_content_are_kept_and_named(run, here):
    (here / "there").mkdir()
    (here / "shape.obj").write_text("mtllib shape.mtl\n" + (here / "shape.obj").read_text())
    (here / "shape.mtl").write_text("newmtl oak\n")
    into = (*DEFORM[:-1], "--json", "--force", "-o", "there/out.obj")
    told = json.loads(run(*into).out)
    assert (told["files"], told["warnings"]) == (["there/out.obj", "there/shape.mtl"], [])
    assert json.loads(run(*into).out)["warnings"] == []
    (here / "there" / "shape.mtl").write_text("newmtl steel\n")
    ran = run(*into)
    sentence = "there/shape.mtl: kept, although it is not the 'shape.mtl' that the shape names"
    assert (ran.code, ran.err) == (0, f"neuralmls: warning: {sentence}\n")
    assert json.loads(ran.out)["warnings"] == [sentence]
    assert json.loads(ran.out)["files"] == ["there/out.obj"]
    assert (here / "there" / "shape.mtl").read_text() == "newmtl steel\n"


def test_companions_that_are_missing_or_lead_out_are_named(run, here):
    (here / "shape.obj").write_text("mtllib none.mtl\nmtllib ../out.mtl\n" + (here / "shape.obj").read_text())
    (here.parent / "out.mtl").write_text("newmtl oak\n")
    ran = run(*DEFORM[:-1], "--json", "-o", "out.obj")
    sentences = [
        "'none.mtl', which the shape names, is not there: it goes without",
        "'../out.mtl', which the shape names, leads out of its folder: it is left behind",
    ]
    assert ran.code == 0
    assert ran.err == "".join(f"neuralmls: warning: {sentence}\n" for sentence in sentences)
    assert json.loads(ran.out)["warnings"] == sentences
    told = json.loads(run("inspect", "shape.obj", "--json").out)
    assert (told["missing"], told["leads_out"]) == (["none.mtl"], ["../out.mtl"])
    shown = run("inspect", "shape.obj").out
    assert "material libraries       2: none.mtl, ../out.mtl\n" in shown
    assert "files that are missing   none.mtl\n" in shown
    assert "files left behind        ../out.mtl (out of its folder)\n" in shown


@pytest.mark.parametrize("name", ["cloud.asc", "cloud.pts", "cloud.xyzrgb"])
def test_the_ending_of_the_input_is_always_right(run, refused, here, name):
    (here / name).write_text("0.5 0 0.5\n1 1 0.5\n0.5 2 0.5\n0 0 0\n")
    arguments = ("deform", name, *DEFORM[2:])
    assert run(*arguments, "-o", f"bent.{name[6:].upper()}").code == 0
    refused(2, *arguments, "-o", "bent.obj", words=("bent.obj: expected a name that ends in .xyz or", f".{name[6:]}"))


def test_a_name_that_is_too_long_is_blamed_and_not_standard_output(refused):
    name = "a" * 300 + ".obj"
    refused(1, *DEFORM, "-o", name, words=(f"{name}: cannot write here: File name too long",))
    refused(1, "points", "shape.obj", "-o", "a" * 300 + ".json", words=("aaa.json: cannot write here: File name too",))
    refused(1, "inspect", name, words=(f"{name}: cannot read: File name too long",))


def test_missing_folder(refused):
    refused(1, *DEFORM, "-o", "none/out.obj", words=("none/out.obj", "no folder 'none'"))
    refused(1, "points", "shape.obj", "-o", "none/p.json", words=("no folder 'none'",))
    refused(1, "sample", "chair", "-o", "none/chair.obj", words=("no folder 'none'",))


def test_file_where_a_folder_should_be(refused):
    refused(1, *DEFORM, "-o", "points.csv/out.obj", words=("no folder 'points.csv'",))
    refused(1, "demo", "-o", "points.csv", words=("points.csv", "cannot make this folder"))


def test_a_folder_where_a_file_is_to_be(refused, here):
    (here / "out" / "shape.obj").mkdir(parents=True)
    (here / "p.json").mkdir()
    for force in ((), ("--force",)):
        refused(1, *DEFORM, "-o", "out", *force, words=("out/shape.obj", "folder"))
        refused(1, "points", "shape.obj", "-o", "p.json", *force, words=("p.json", "folder"))
        refused(1, "fit", *DEFORM[1:4], "-o", "out", *force, words=("out", "folder"))


def test_folder_that_is_not_writable(refused, here):
    folder = here / "locked"
    folder.mkdir()
    folder.chmod(0o555)
    if os.access(folder, os.W_OK):
        pytest.skip("this user may write anywhere (root)")
    refused(1, *DEFORM, "-o", "locked/out.obj", words=("locked", "not writable"))


@pytest.mark.skipif(not os.path.isdir("/proc/self"), reason="there is no /proc, where not even root may write")
def test_folder_where_not_even_root_may_write(refused):
    refused(1, *DEFORM, "-o", "/proc/out.obj", words=("/proc/out.obj", "cannot write"))


# Files of at most so many bytes: writing more fails as on a full disk.
FULL = """
import resource, signal, sys
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (64, 64))
from neuralmls.cli import main
sys.exit(main())
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no limit of the size of files")
@pytest.mark.parametrize("there", [False, True])
def test_full_disk_leaves_everything_as_it_was(process, here, content, there):
    if there:
        (here / "out.obj").write_text("precious")
    before = content()
    ran = process(*DEFORM, "-o", "out.obj", "--force", program=FULL)
    assert (ran.code, ran.out) == (1, b"")
    assert ran.err.startswith(b"neuralmls: error: out.obj: cannot write: ")
    assert ran.err.count(b"\n") == 1
    assert content() == before


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="there is no /dev/full")
@pytest.mark.parametrize("arguments", [(*DEFORM, "-o", "-"), ("inspect", "shape.obj"), ("--help",)])
def test_full_standard_output(process, arguments):
    with open("/dev/full", "wb") as full:
        ran = process(*arguments, stdout=full)
    assert ran.code == 1
    assert ran.err == b"neuralmls: error: standard output: cannot write: No space left on device\n"


def test_reader_that_goes_away_is_no_error_to_speak_of(process):
    reader, writer = os.pipe()
    os.close(reader)
    ran = process(*DEFORM, "-o", "-", stdout=writer)
    os.close(writer)
    assert (ran.code, ran.err) == (1, b"")


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to send to one process")
def test_interrupt_writes_nothing(start, content):
    before = content()
    # Far more steps than anybody waits for: it can only end by the interrupt.
    with start("deform", "shape.obj", "--points", "points.csv", "-o", "out.obj", "--steps", "1000000") as running:
        warned = running.stderr.readline()  # said just before the training starts
        assert warned.startswith(b"neuralmls: warning: no control point is moved")
        time.sleep(0.5)
        assert running.poll() is None
        running.send_signal(signal.SIGINT)
        out, err = running.communicate(timeout=20)
    assert (running.returncode, out, err) == (130, b"", b"neuralmls: interrupted\n")
    assert content() == before
