"""How to cite it, who made it, which version: said in several files, the same in all."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml

import neuralmls

ROOT = Path(__file__).resolve().parents[1]
# Of the Citation File Format 1.2.0: what a file may say, must say, and must say of each reference.
KEYS = {
    "abstract", "authors", "cff-version", "commit", "contact", "date-released", "doi", "identifiers", "keywords",
    "license", "license-url", "message", "preferred-citation", "references", "repository", "repository-artifact",
    "repository-code", "title", "type", "url", "version",
}  # fmt: skip
REQUIRED = {"authors", "cff-version", "message", "title"}
OF_A_REFERENCE = {"authors", "title", "type"}


def toml(name: str) -> dict[str, Any]:
    return tomllib.loads((ROOT / name).read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def citation() -> dict[str, Any]:
    found: dict[str, Any] = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    return found


@pytest.fixture(scope="module")
def bibtex() -> dict[str, dict[str, str]]:
    """The entries of the README by their kind, without braces inside of a field."""
    [block] = re.findall(r"```bibtex\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.DOTALL)
    return {
        kind: {name: re.sub("[{}]", "", value) for name, value in re.findall(r"(\w+)\s*=\s*\{(.*)\}", fields)}
        for kind, fields in re.findall(r"^@(\w+)\{\w+,\n(.*?)^\}", block, re.DOTALL | re.MULTILINE)
    }


def test_the_version_is_the_same_wherever_it_stands(citation, bibtex):
    locked = {
        f"{lock}: {package['name']}": package["version"]
        for lock in ("Cargo.lock", "fuzz/Cargo.lock")
        for package in toml(lock)["package"]
        if "source" not in package and package["name"] != "neuralmls-fuzz"
    }
    editor = json.loads((ROOT / "editor/package-lock.json").read_text(encoding="utf-8"))
    [latest, *_] = re.findall(r"^## ([\d.]+)", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE)
    said = {
        "Cargo.toml": toml("Cargo.toml")["workspace"]["package"]["version"],
        "research/pyproject.toml": toml("research/pyproject.toml")["project"]["version"],
        "editor/package.json": json.loads((ROOT / "editor/package.json").read_text(encoding="utf-8"))["version"],
        "editor/package-lock.json": editor["version"],
        "editor/package-lock.json, its package": editor["packages"][""]["version"],
        "CITATION.cff": citation["version"],
        "README.md": bibtex["software"]["version"],
        "CHANGELOG.md": latest,
        **locked,
    }
    assert len(locked) > 6
    assert said == dict.fromkeys(said, neuralmls.__version__)


def test_the_authors_are_the_same_wherever_they_stand(citation, bibtex):
    who = "NeuralMLS contributors"
    assert citation["authors"] == [{"name": who}]
    assert bibtex["software"]["author"] == who
    assert json.loads((ROOT / "editor/package.json").read_text(encoding="utf-8"))["author"] == who
    for manifest in ("pyproject.toml", "research/pyproject.toml"):
        assert toml(manifest)["project"]["authors"] == [{"name": who}], manifest


def test_the_citation_file_says_what_its_format_asks_for(citation):
    assert citation["cff-version"] == "1.2.0"
    assert set(citation) >= REQUIRED
    assert set(citation) <= KEYS
    assert citation["type"] == "software"
    assert citation["license"] == toml("pyproject.toml")["project"]["license"]
    for reference in citation["references"]:
        assert set(reference) >= OF_A_REFERENCE
        assert all({"family-names", "given-names"} <= set(author) for author in reference["authors"])
        assert re.fullmatch(r"10\.\d{4,9}/\S+", reference["doi"])


def test_the_paper_is_cited_alike_in_both_forms(citation, bibtex):
    [paper] = citation["references"]
    entry = bibtex["inproceedings"]
    authors = [f"{author['family-names']}, {author['given-names']}" for author in paper["authors"]]
    assert entry["author"].split(" and ") == authors
    assert (entry["title"], entry["booktitle"]) == (paper["title"], paper["collection-title"])
    assert (entry["doi"], int(entry["year"])) == (paper["doi"], paper["year"])
    assert bibtex["software"]["title"] == citation["title"]
    address = f"https://arxiv.org/abs/{entry['note'].removeprefix('arXiv:')}"
    assert address == paper["url"]
    for manifest in ("pyproject.toml", "research/pyproject.toml"):
        assert toml(manifest)["project"]["urls"] == {"Paper": address}, manifest
