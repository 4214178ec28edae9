"""The page of a figure: panels side by side, in rows, titles above, a legend below."""

from __future__ import annotations

import io
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from neuralmls.figures.palette import INK, Colour, heat

Picture = NDArray[np.uint8]


def png(
    pictures: Sequence[Picture],
    titles: Sequence[str],
    width: int,
    *,
    columns: int,
    legend: Sequence[tuple[Colour, str]] = (),
    scale: tuple[str, str] | None = None,
) -> bytes:
    """The bytes of a PNG file `width` pixels wide.

    Parameters
    ----------
    pictures : panels of the same size, (height, width, 3), larger than they are to be shown
    titles : one for each panel; what does not fit is cut off in front, where paths are least telling
    columns : panels in a row
    legend : colours of balls, and what they mean, from right to left
    scale : what stands at the two ends of the heat map in the legend, if it is explained there
    """
    from PIL import Image, ImageDraw

    panel_width = width // columns
    panel_height = round(panel_width * pictures[0].shape[0] / pictures[0].shape[1])
    text = max(round(min(max(width / 64, 13), panel_width / 14)), 9)
    band = round(2.2 * text)
    rows = -(-len(pictures) // columns)
    page = Image.new("RGB", (width, rows * (panel_height + band) + band), "white")
    pen = ImageDraw.Draw(page)
    font = _font(text)
    for i, (picture, title) in enumerate(zip(pictures, titles, strict=True)):
        small = Image.fromarray(picture).resize((panel_width, panel_height), Image.Resampling.LANCZOS)
        left, top = i % columns * panel_width, i // columns * (panel_height + band)
        page.paste(small, (left, top + band))
        while pen.textlength(title, font=font) > 0.95 * panel_width and len(title) > 2:
            title = "…" + title.lstrip("…")[1:]
        pen.text((left + panel_width / 2, top + band / 2 + 2), title, fill=_rgb(INK), font=font, anchor="mm")
    x, y = float(width - text), page.height - 0.5 * band
    font = _font(round(0.75 * text))
    for colour, label in legend:
        pen.text((x, y), label, fill=_rgb(INK), font=font, anchor="rm")
        x -= pen.textlength(label, font=font) + 0.7 * text
        r = 0.3 * text
        dot = Image.new("L", (64, 64))
        ImageDraw.Draw(dot).ellipse((0, 0, 63, 63), fill=255)
        dot = dot.resize((round(2 * r), round(2 * r)), Image.Resampling.LANCZOS)
        page.paste(_rgb(colour), (round(x - r), round(y - r)), dot)
        x -= 1.2 * text
    if scale is not None:
        low, high = scale
        pen.text((text, y), low, fill=_rgb(INK), font=font, anchor="lm")
        left = round(1.4 * text + pen.textlength(low, font=font))
        bar = np.repeat(heat(np.linspace(0, 1, 9 * text))[None], round(0.6 * text), axis=0)
        page.paste(Image.fromarray((bar * 255).round().astype(np.uint8)), (left, round(y - 0.3 * text)))
        pen.text((left + 9.4 * text, y), high, fill=_rgb(INK), font=font, anchor="lm")
    out = io.BytesIO()
    page.save(out, "PNG")
    return out.getvalue()


def _font(size: int):  # type: ignore[no-untyped-def]
    from PIL import ImageFont

    return ImageFont.load_default(size)


def _rgb(colour: Colour) -> tuple[int, int, int]:
    red, green, blue = (round(255 * value) for value in colour)
    return red, green, blue
