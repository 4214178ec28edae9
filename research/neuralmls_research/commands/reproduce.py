"""`neuralmls reproduce`: the paper's figures and tables, drawn from runs on this machine."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

import click

from neuralmls.cli.plugin import Stages, console, options, outputs


@click.command()
@click.argument("items", nargs=-1, metavar="[ITEM]...")
@options.output("The folder to write into.")
@click.option(
    "--seeds",
    type=click.IntRange(min=1),
    default=4,
    show_default=True,
    metavar="N",
    help="Train every network N times, seeds 0 to N - 1: a verdict holds for all of them.",
)
@options.quiet
@options.force
def reproduce(*, items: tuple[str, ...], output: Path, seeds: int, quiet: bool, force: bool) -> None:
    """Draw the paper's figures and tables from own runs.

    \b
    fig1 fig2 fig3 square fig4 fig5 table1 fig6 fig7 fig8 fig9 fig10 training
    fourier or all, as without an ITEM. Writes pictures (PNG, SVG, PDF),
    tables (CSV, LaTeX), index.html and numbers.json.

    The paper's own shapes are used where $NEURALMLS_DATA has them, ours otherwise.
    """
    from neuralmls_research.experiments.reproduce.items import chosen
    from neuralmls_research.experiments.reproduce.lab import Lab
    from neuralmls_research.experiments.reproduce.run import NUMBERS, PAGE

    selected, lab = chosen(items or ("all",)), Lab.of(output, tuple(range(seeds)))
    outputs.make_folder(output)
    for name in (PAGE, NUMBERS):
        outputs.check_output(output / name, force=force)

    from neuralmls.figures.stage import pyvista_or_refuse
    from neuralmls_research.baselines.checks import library
    from neuralmls_research.experiments.reproduce.run import reproduce as run
    from neuralmls_research.scatter import matplotlib_or_refuse

    for module in ("PIL", "igl", "safetensors", "scipy"):  # now, and not when the item is reached that needs it
        library(module, "reproduce")
    pyvista_or_refuse()
    matplotlib_or_refuse()
    stages = Stages(quiet=quiet)
    page, reports = run(selected, lab, stages.stage)
    if quiet:
        return
    told = Counter(claim.verdict for report in reports.values() for claim in report.claims if not claim.ours)
    for item, report in reports.items():
        for sentence in report.missing:
            console.warning(f"{item.name}: {sentence}")
    rows = [
        (claim.verdict, "Our own check. " * claim.ours + claim.paper, item.name)
        for item, report in reports.items()
        for claim in report.claims
    ]
    console.table(["verdict", "claim", "item"], rows, file=sys.stdout)
    console.line(f"{page}: {', '.join(f'{count} {verdict}' for verdict, count in told.items())}", sys.stdout)
    console.line(f"{sum(stages.seconds.values()):.0f} seconds in all", sys.stdout)
