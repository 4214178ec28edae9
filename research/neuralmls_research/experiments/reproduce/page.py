"""The page of all experiments: claims first, then each figure with what it shows. One folder, relative links."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape

from neuralmls_research.experiments.reproduce.formats import PICTURES, TABLES, files
from neuralmls_research.experiments.reproduce.items import Item
from neuralmls_research.experiments.reproduce.report import Claim, Report, Table
from neuralmls_research.experiments.reproduce.verdicts import Verdict

MARKS = {Verdict.REPRODUCED: "yes", Verdict.PARTLY: "part", Verdict.CONTRADICTED: "no", Verdict.UNTESTABLE: "open"}
STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 1280px; margin: 0 auto; padding: 24px; }
h1 { font-size: 28px; margin: 8px 0; }
h2 { font-size: 21px; margin: 56px 0 4px; padding-top: 12px; border-top: 1px solid #ddd; }
nav a { margin-right: 14px; white-space: nowrap; }
a { color: #0b5cad; }
p { max-width: 860px; }
.setting { color: #555; font-size: 14px; }
figure { margin: 20px 0; }
figure img { max-width: 100%; height: auto; display: block; }
figcaption, caption { font-size: 14px; color: #333; text-align: left; max-width: 860px; padding: 6px 0; }
.wide { overflow-x: auto; margin: 16px 0; }
table { border-collapse: collapse; font-size: 14px; }
th, td { padding: 5px 10px; border-bottom: 1px solid #e3e3e3; text-align: left; vertical-align: top; }
.measures td + td, .measures th + th { text-align: right; font-variant-numeric: tabular-nums; }
.measures td:first-child { white-space: nowrap; }
.yes, .part, .no, .open { display: inline-block; border-radius: 4px; padding: 1px 8px; font-size: 13px;
  white-space: nowrap; }
.yes { background: #dcefe0; color: #14532d; }
.part { background: #fff1c9; color: #6b4a00; }
.no { background: #f9dedc; color: #7f1d1d; }
.open { background: #ececec; color: #444; }
.claims td:first-child { min-width: 180px; }
.claims td { min-width: 120px; }
.claims .rule { color: #555; }
.claims tr.ours { background: #f7f7f7; }
.files { font-size: 13px; color: #555; }
.missing { background: #fff6dd; border-left: 4px solid #e0b437; padding: 8px 14px; max-width: 840px; }
.missing ul { margin: 4px 0; padding-left: 20px; }
"""


def page(reports: Mapping[Item, Report], version: str) -> str:
    """The HTML of the page."""
    claims = [(item, claim) for item, report in reports.items() for claim in report.claims]
    counts = [f"{sum(c.verdict == verdict and not c.ours for _, c in claims)} {verdict.value}" for verdict in MARKS]
    beside = sum(claim.ours for _, claim in claims)
    own = f"; {beside} checks of our own, marked so, do not count" if beside else ""
    missing = [(item, sentence) for item, report in reports.items() for sentence in report.missing]
    rows = "".join(_claim_row(claim, item) for item, claim in claims)
    sections = "".join(_section(item, report) for item, report in reports.items())
    links = "".join(f'<a href="#{item.name}">{escape(item.title.split(":")[0])}</a> ' for item in reports)
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>NeuralMLS: the paper's experiments</title>
<style>{STYLE}</style>
</head>
<body>
<h1>The experiments of NeuralMLS, run again</h1>
<p id="claims">What the paper says, and what came out: <strong>{", ".join(counts)}</strong>{own}.
The claims are in our words. The rules stand in the code, and were there before this run; those that were worded after
an earlier run had been seen are named in docs/reproduction.md. {_files("verdicts", TABLES)}</p>
<div class="wide"><table class="claims">
<thead><tr><th>what the paper says</th><th>verdict</th><th>its measure, and the rule</th>
<th>measured here</th><th>what to conclude</th></tr></thead>
<tbody>{rows}</tbody>
</table></div>
<p>Shechter, Hanocka, Metzer, Giryes, Cohen-Or, “NeuralMLS: Geometry-Aware Control Point Deformation”, Eurographics 2022
(<a href="https://arxiv.org/abs/2201.01873">arXiv 2201.01873</a>). Every figure and number here was made by neuralmls
{escape(version)} in one run of <code>neuralmls reproduce</code>; the numbers, with the code, the seeds and the machine
that made them, are in <a href="numbers.json">numbers.json</a> too. The paper gives no number of training steps and no
rate: ours are the published code's. Lengths are in halves of the shape's longest side.</p>
{_missing(missing)}
<nav>{links}</nav>
{sections}
</body>
</html>
"""


def _missing(missing: list[tuple[Item, str]]) -> str:
    if not missing:
        return ""
    lines = "".join(
        f'<li><a href="#{item.name}">{item.name}</a>: {escape(sentence)}</li>' for item, sentence in missing
    )
    said = "What could not be run as in the paper; a verdict on a shape that stands in is one on that shape:"
    return f'<div class="missing">{said}<ul>{lines}</ul></div>'


def verdicts(reports: Mapping[Item, Report]) -> Table:
    """All claims as a table."""
    head = ["item", "what the paper says", "verdict", "its measure", "rule", "measured here", "what to conclude"]
    rows = [
        [
            item.name,
            ("Our own check. " if c.ours else "") + c.paper,
            c.verdict.value,
            c.measure,
            c.ruling.rule,
            c.measured,
            c.reader,
        ]
        for item, report in reports.items()
        for c in report.claims
    ]
    return Table("verdicts", "What the paper says, and what came out.", head, rows)


def _claim_row(claim: Claim, item: Item) -> str:
    verdict = f'<span class="{MARKS[claim.verdict]}">{claim.verdict.value}</span>'
    own = "<em>Our own check.</em> " if claim.ours else ""
    said = f'{own}{escape(claim.paper)} (<a href="#{item.name}">{item.name}</a>)'
    measure = f'{escape(claim.measure)}<br><span class="rule">Rule: {escape(claim.ruling.rule)}</span>'
    row = "".join(f"<td>{cell}</td>" for cell in (said, verdict, measure, escape(claim.measured), escape(claim.reader)))
    return f'<tr class="ours">{row}</tr>' if claim.ours else f"<tr>{row}</tr>"


def _files(name: str, suffixes: Sequence[str]) -> str:
    """Links to a file in all its formats."""
    links = (f'<a href="{escape(file)}">{file.rpartition(".")[2].upper()}</a>' for file in files(name, suffixes))
    return f'<span class="files">{" ".join(links)}</span>'


def _section(item: Item, report: Report) -> str:
    figures = "".join(
        f'<figure><img src="{escape(picture.file)}" alt="{escape(picture.caption)}" loading="lazy">'
        f"<figcaption>{escape(picture.caption)} {_files(picture.file, PICTURES)}</figcaption></figure>"
        for picture in report.pictures
    )
    tables = "".join(map(_table, report.tables))
    setting = report.setting[:1].upper() + report.setting[1:]
    return f'<h2 id="{item.name}">{escape(item.title)}</h2><p class="setting">{escape(setting)}</p>{figures}{tables}'


def _table(table: Table) -> str:
    head = "".join(f"<th>{escape(title)}</th>" for title in table.head)
    rows = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in table.rows)
    caption = f"{escape(table.caption)} {_files(table.name, TABLES)}"
    return (
        f'<div class="wide"><table class="measures"><caption>{caption}</caption>'
        f"<thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>"
    )
